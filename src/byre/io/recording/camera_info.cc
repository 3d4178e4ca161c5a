#include "byre/io/recording/camera_info.h"

#include "byre/calibration_file.h"
#include "byre/input_error.h"
#include "byre/io/calibration/calibration_formats.h"
#include "byre/io/calibration/camera_fields.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <string_view>
#include <utility>

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

// OpenCV's models by their ROS names, and byre's by their own.
void take_distortion(const CameraInfoWithSource& placed, Camera& camera) {
  constexpr std::array kOpenCvNames = {"plumb_bob", "rational_polynomial", "thin_prism", "equidistant", "fisheye"};
  const ros::CameraInfo& info = placed.info;
  const std::string& name = info.distortion_model;
  if (name.empty() && info.d.empty()) return;
  const auto unsupported = [&] {
    refuse(placed,
           "has the unsupported lens model \"" + name.substr(0, 40) + "\" with " + std::to_string(info.d.size()) +
               " coefficients",
           "calibrate with plumb_bob (5), rational_polynomial (8) or equidistant (4), or publish rectified images");
  };
  for (int model = 0; model < kCameraModels; ++model) {
    if (to_string(static_cast<CameraModel>(model)) != name || name == "equidistant") continue;
    if (info.d.size() > camera.distortion.size()) unsupported();
    camera.model = static_cast<CameraModel>(model);
    std::ranges::copy(info.d, camera.distortion.begin());
    return require_valid(camera, placed.place);
  }
  const bool is_fisheye = name == "equidistant" || name == "fisheye";
  const bool is_ideal = std::ranges::all_of(info.d, [](double coefficient) { return coefficient == 0.0; });
  if (!is_fisheye && is_ideal) return;
  if (std::ranges::find(kOpenCvNames, name) == kOpenCvNames.end()) unsupported();
  try {
    set_opencv_distortion(camera, info.d, is_fisheye, placed.place);
  } catch (const InputError&) {
    unsupported();
  }
}

RectifiedView view_of(const CameraInfoWithSource& placed) {
  RectifiedView view;
  if (!placed.is_rectified) {
    view.rotation = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(placed.info.r.data());
  }
  view.projection = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(placed.info.p.data());
  return view;
}

// The views of a pair. A positive baseline in the right camera's P alone is a sign error of the driver: the REP defines
// it as negative.
std::pair<RectifiedView, RectifiedView> views_of(const CameraInfoWithSource& left, const CameraInfoWithSource& right) {
  std::pair views(view_of(left), view_of(right));
  if (has_positive_baseline(left, right)) views.second.projection(0, 3) *= -1.0;
  return views;
}

bool has_baseline(const std::pair<RectifiedView, RectifiedView>& views) {
  return views.first.projection.col(3) != views.second.projection.col(3);
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
  const auto views = views_of(left, right);
  std::optional<Pose> right_from_left = byre::right_from_left(views.first, views.second);
  if (!right_from_left) right_from_left = frames.between(right.info.header.frame_id, left.info.header.frame_id);
  if (!right_from_left && has_baseline(views)) {
    for (const auto& [each, view] : {std::pair(&left, &views.first), std::pair(&right, &views.second)}) {
      if (rotation_from_matrix(view->rotation)) continue;
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

bool has_positive_baseline(const CameraInfoWithSource& left, const CameraInfoWithSource& right) {
  return right.info.p[3] > 0.0 && left.info.p[3] == 0.0;
}

std::optional<DepthCamera> depth_camera_of(const CameraInfoWithSource& own, bool is_named_registered,
                                           const Camera& left, const std::string& left_frame,
                                           const StaticFrames& frames) {
  const ros::CameraInfo& info = own.info;
  const bool is_of_left =
      is_named_registered || frame_without_slash(info.header.frame_id) == frame_without_slash(left_frame);
  const bool has_size = info.width != 0 && info.height != 0;
  const bool is_as_left =
      info.width == static_cast<std::uint32_t>(left.width) && info.height == static_cast<std::uint32_t>(left.height);
  if (is_of_left && (is_as_left || !has_size)) return DepthCamera{};
  const std::optional<Pose> left_from_depth = frames.between(left_frame, info.header.frame_id);
  if (!left_from_depth) return std::nullopt;
  DepthCamera depth;
  depth.camera = camera_of(own);
  depth.left_from_depth = *left_from_depth;
  return depth;
}

Pose body_from_camera(const std::string& camera_frame, const StaticFrames& frames) {
  return frames.between("base_link", camera_frame).value_or(Pose());
}

}  // namespace byre
