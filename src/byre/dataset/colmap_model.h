#pragma once

#include "byre/calibration.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace byre {

// A structure-from-motion model as COLMAP keeps it, with its own ids, by plain values.
// Format: https://colmap.github.io/format.html. Pixels are as COLMAP counts them: (0.5, 0.5) is the centre of the
// top-left pixel, half a pixel more than byre's.

struct ColmapCamera {
  std::string model;  // name of the model, such as "OPENCV"
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::vector<double> parameters;  // parameters in the model's order, as many as it has
};

struct ColmapKeypoint {
  Eigen::Vector2d pixel;                  // COLMAP's pixels, of the original image
  std::optional<std::uint64_t> point_id;  // empty where it is of no point
};

struct ColmapImage {
  std::string name;  // file, relative to the folder of images
  std::uint32_t camera_id = 0;
  Pose camera_from_world;
  std::vector<ColmapKeypoint> keypoints;
};

struct ColmapTrackEntry {
  std::uint32_t image_id = 0;
  std::uint32_t keypoint = 0;  // index into ColmapImage::keypoints
};

struct ColmapPoint {
  Eigen::Vector3d position_in_world;     // the model's own unit
  std::array<std::uint8_t, 3> colour{};  // red, green, blue
  double error = -1.0;                   // mean reprojection error in pixels, negative where unknown
  std::vector<ColmapTrackEntry> track;
};

struct ColmapModel {
  std::map<std::uint32_t, ColmapCamera> cameras;
  std::map<std::uint32_t, ColmapImage> images;
  std::map<std::uint64_t, ColmapPoint> points;
};

enum class ColmapFormat : std::uint8_t { text, binary };

// Reads cameras, images and points3D (.bin, or .txt where the binary ones are not all there) of a folder. Throws
// InputError naming file and line, or byte, on anything that is not as the format says, and on ids that are given
// twice or lead nowhere.
ColmapModel read_colmap_model(const std::filesystem::path& folder);

// Writes the three files into a folder that exists; numbers so that reading gives the same doubles. Throws InputError
// when a file cannot be written.
void write_colmap_model(const ColmapModel& model, const std::filesystem::path& folder, ColmapFormat format);

}  // namespace byre
