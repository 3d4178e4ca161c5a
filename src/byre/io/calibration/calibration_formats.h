#pragma once

#include "byre/calibration_file.h"
#include "byre/io/calibration/calibration_fields.h"

#include <Eigen/Core>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace byre {

// Rotation to the rectified camera, and its projection matrix, as ROS' R and P.
struct RectifiedView {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> projection = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>::Zero();
};

// Pose of the left camera in the right one. The baseline is the difference of the fourth columns of both matrices, so
// either camera may be the reference. Empty without a baseline, and if a matrix is not a rotation.
std::optional<Pose> right_from_left(const RectifiedView& left, const RectifiedView& right);

// A camera of a file, and the poses that the file has.
struct PlacedCamera {
  Camera camera;  // width and height are zero if the file does not have them
  std::optional<Pose> body_from_camera{};
  std::optional<Pose> from_previous{};  // this camera from the previous one
  std::optional<RectifiedView> rectified{};
  double readout_time = 0.0;  // seconds
  std::string pose_place{};   // field that places the camera, for InputError
};

struct CameraList {
  std::string format;
  std::vector<PlacedCamera> cameras;  // at least one
  std::vector<std::string> notes{};
  std::vector<std::string> names{};  // names of the cameras; empty: left and right
};

// Cameras of a file in the first matching format, also inside other fields. size: width and height, for files with
// several. The path may name one camera. Throws InputError if there is no camera, and for invalid fields.
CameraList read_cameras(const std::filesystem::path& path, std::optional<std::pair<int, int>> size = std::nullopt);

// Rotation and translation of a pair that is stored apart from its intrinsics, as OpenCV's extrinsics.yml; empty if the
// file has none.
std::optional<Pose> read_opencv_extrinsics(const std::filesystem::path& path);

}  // namespace byre
