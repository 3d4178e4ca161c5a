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

// A structure-from-motion model in COLMAP's format, with its own ids, as plain values. Format:
// https://colmap.github.io/format.html. Pixels are COLMAP's: (0.5, 0.5) is the centre of the top-left pixel, half a
// pixel more than in byre.

struct ColmapCamera {
  std::string model;  // name of the model, such as "OPENCV"
  std::uint64_t width = 0;
  std::uint64_t height = 0;
  std::vector<double> parameters;  // parameters in the model's order and number
};

struct ColmapKeypoint {
  Eigen::Vector2d pixel;                  // COLMAP's pixels, of the original image
  std::optional<std::uint64_t> point_id;  // empty without a point
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
  double error = -1.0;                   // mean reprojection error in pixels, negative if unknown
  std::vector<ColmapTrackEntry> track;
};

struct ColmapModel {
  std::map<std::uint32_t, ColmapCamera> cameras;
  std::map<std::uint32_t, ColmapImage> images;
  std::map<std::uint64_t, ColmapPoint> points;
};

enum class ColmapFormat : std::uint8_t { text, binary };

// Reads cameras, images and points3D of a folder (.bin; .txt if a binary file is missing). Throws InputError with file
// and line, or byte, for violations of the format, duplicate ids and dangling references.
ColmapModel read_colmap_model(const std::filesystem::path& folder);

// Writes the three files to an existing folder; numbers round-trip exactly. Throws InputError if a file cannot be
// written.
void write_colmap_model(const ColmapModel& model, const std::filesystem::path& folder, ColmapFormat format);

}  // namespace byre
