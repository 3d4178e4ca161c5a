#include "byre/io/recording/camera_info.h"

#include "byre/calibration_file.h"
#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

namespace byre {
namespace {

constexpr std::string_view kGiveFile = "give a calibration file of the cameras";

[[noreturn]] void refuse(const CameraInfoWithSource& placed, const std::string& reason,
                         const std::string& remedy = {}) {
  throw InputError(placed.place, reason,
                   remedy.empty() ? std::string(kGiveFile) : remedy + ", or " + std::string(kGiveFile));
}

bool all_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

void require_valid(const CameraInfoWithSource& placed) {
  constexpr std::uint32_t kMostSide = 1U << 16U;  // pixels
  const ros::CameraInfo& info = placed.info;
  if (!all_finite(info.k) || !all_finite(info.d) || !all_finite(info.r) || !all_finite(info.p)) {
    refuse(placed, "contains values that are not finite");
  }
  if (!(info.k[0] > 0.0) || !(info.k[4] > 0.0))
    refuse(placed, "describes an uncalibrated camera: its focal lengths are not positive");
  const bool has_size = info.width > 0 && info.height > 0 && info.width <= kMostSide && info.height <= kMostSide;
  if (!has_size) refuse(placed, "has no width and height", "correct the camera info of the driver");
  const ros::RegionOfInterest& roi = info.roi;
  const bool is_cut = roi.x_offset != 0 || roi.y_offset != 0 || (roi.width != 0 && roi.width != info.width) ||
                      (roi.height != 0 && roi.height != info.height);
  if (is_cut)
    refuse(placed, "describes a region of interest, not the whole image", "let the driver publish whole images");
  if (info.binning_x > 1 || info.binning_y > 1) {
    refuse(placed, "describes binned images", "calibrate at the size of the binned images");
  }
}

// "plumb_bob" (k1, k2, p1, p2, k3), "rational_polynomial" without its last terms, "equidistant" (k1..k4).
void take_distortion(const CameraInfoWithSource& placed, Camera& camera) {
  const ros::CameraInfo& info = placed.info;
  const auto is_zero = [](double coefficient) { return coefficient == 0.0; };
  const bool is_fisheye = info.distortion_model == "equidistant" || info.distortion_model == "fisheye";
  if (!is_fisheye && std::ranges::all_of(info.d, is_zero)) return;
  const bool is_radial = info.distortion_model == "plumb_bob" || info.distortion_model == "rational_polynomial";
  const std::size_t known = is_fisheye ? 4 : 5;
  const std::size_t count = std::min(known, info.d.size());
  const bool has_more =
      !std::all_of(info.d.begin() + static_cast<std::ptrdiff_t>(count), info.d.end(), is_zero) || count < 4;
  if ((!is_fisheye && !is_radial) || has_more) {
    refuse(placed,
           "has the unsupported lens model \"" + info.distortion_model.substr(0, 40) + "\" with " +
               std::to_string(info.d.size()) + " coefficients",
           "calibrate with plumb_bob (5) or equidistant (4), or publish rectified images");
  }
  camera.model = is_fisheye ? CameraModel::equidistant : CameraModel::radial_tangential;
  std::copy_n(info.d.begin(), count, camera.distortion.begin());
}

Eigen::Matrix3d rotation_of(const ros::CameraInfo& info) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.r.data());
}

// Translation from the rectified left frame to the right one.
Eigen::Vector3d shift_of(const ros::CameraInfo& right) {
  return {right.p[3] / right.p[0], right.p[7] / right.p[5], 0.0};
}

bool has_baseline(const ros::CameraInfo& right) {
  return right.p[0] > 0.0 && right.p[5] > 0.0 && right.p[3] != 0.0;
}

std::optional<Pose> by_projections(const CameraInfoWithSource& left, const CameraInfoWithSource& right) {
  if (!has_baseline(right.info)) return std::nullopt;
  if (right.is_rectified) return Pose{Eigen::Quaterniond::Identity(), shift_of(right.info)};
  const auto left_rotation = rotation_from_matrix(rotation_of(left.info));
  const auto right_rotation = rotation_from_matrix(rotation_of(right.info));
  if (!left_rotation || !right_rotation) return std::nullopt;
  const Pose rectified_from_left{*left_rotation, Eigen::Vector3d::Zero()};
  const Pose rectified_from_right{*right_rotation, Eigen::Vector3d::Zero()};
  return inverse(rectified_from_right) * Pose{Eigen::Quaterniond::Identity(), shift_of(right.info)} *
         rectified_from_left;
}

}  // namespace

Camera camera_of(const CameraInfoWithSource& placed) {
  const ros::CameraInfo& info = placed.info;
  require_valid(placed);
  Camera camera{.width = static_cast<int>(info.width), .height = static_cast<int>(info.height)};
  if (placed.is_rectified && info.p[0] > 0.0 && info.p[5] > 0.0) {
    camera.fx = info.p[0], camera.fy = info.p[5], camera.cx = info.p[2], camera.cy = info.p[6];
    return camera;
  }
  camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  if (!placed.is_rectified) take_distortion(placed, camera);
  return camera;
}

StereoPartner partner_of(const CameraInfoWithSource& left, const CameraInfoWithSource& right,
                         const StaticFrames& frames) {
  require_valid(right);
  if (right.info.p[3] > 0.0) {
    refuse(right, "places the right camera to the left of the left camera: the fourth value of P is positive",
           "swap left and right");
  }
  std::optional<Pose> right_from_left = by_projections(left, right);
  if (!right_from_left) right_from_left = frames.between(right.info.header.frame_id, left.info.header.frame_id);
  if (!right_from_left && has_baseline(right.info)) {
    for (const CameraInfoWithSource* const each : {&left, &right}) {
      if (rotation_from_matrix(rotation_of(each->info))) continue;
      refuse(*each, "has a matrix R that is not a rotation", "correct R in the calibration of the driver");
    }
  }
  if (!right_from_left) {
    refuse(right, "has no baseline in P, and /tf_static does not connect the frame \"" + left.info.header.frame_id +
                      "\" to \"" + right.info.header.frame_id + "\"");
  }
  StereoPartner partner{camera_of(right), *right_from_left};
  require_baseline(partner, right.place);
  return partner;
}

Pose body_from_camera(const std::string& camera_frame, const StaticFrames& frames) {
  return frames.between("base_link", camera_frame).value_or(Pose());
}

}  // namespace byre
