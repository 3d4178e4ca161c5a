#include "byre/node/camera_info.h"

#include "byre/input_error.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace byre {
namespace {

constexpr int kMostSide = 1 << 16;  // pixels

[[noreturn]] void refuse(const std::string& topic, const std::string& reason, const std::string& remedy) {
  throw InputError(topic, reason, remedy);
}

bool all_finite(std::span<const double> numbers) {
  return std::ranges::all_of(numbers, [](double number) { return std::isfinite(number); });
}

void require_sense(const ros::CameraInfo& info, const std::string& topic) {
  if (info.k[0] == 0.0) refuse(topic, "says that the camera is not calibrated", "calibrate it, or name a file");
  if (!all_finite(info.k) || !all_finite(info.d) || !all_finite(info.r) || !all_finite(info.p)) {
    refuse(topic, "holds numbers that are none", "calibrate the camera again");
  }
  const bool has_size = info.width > 0 && info.height > 0 && info.width <= kMostSide && info.height <= kMostSide;
  if (!has_size) refuse(topic, "has no width and height", "correct what the camera's driver says");
  const ros::RegionOfInterest& roi = info.roi;
  const bool is_part = roi.x_offset != 0 || roi.y_offset != 0 || (roi.width != 0 && roi.width != info.width) ||
                       (roi.height != 0 && roi.height != info.height);
  if (info.binning_x > 1 || info.binning_y > 1 || is_part) {
    refuse(topic, "has images that are binned or part of the whole, which is not supported",
           "have the driver send whole images, and calibrate those");
  }
}

void set_distortion(Camera& camera, const ros::CameraInfo& info, const std::string& topic) {
  const bool has_none = std::ranges::all_of(info.d, [](double number) { return number == 0.0; });
  if (has_none && info.distortion_model != "equidistant") return;
  std::span<const double> numbers(info.d);
  if (info.distortion_model == "rational_polynomial" && numbers.size() == 8) {
    const bool is_plain = std::ranges::all_of(numbers.subspan(5), [](double number) { return number == 0.0; });
    if (!is_plain) {
      refuse(topic, "has the model rational_polynomial, which is not supported",
             "calibrate with plumb_bob or equidistant, or send rectified images (images.rectified)");
    }
    numbers = numbers.first(5);
  } else if (info.distortion_model != "plumb_bob" && info.distortion_model != "equidistant") {
    refuse(topic, "has the distortion model '" + info.distortion_model.substr(0, 40) + "', which is not supported",
           "calibrate with plumb_bob or equidistant, or send rectified images (images.rectified)");
  }
  const bool is_fisheye = info.distortion_model == "equidistant";
  if (numbers.size() < 4 || numbers.size() > (is_fisheye ? 4u : 5u)) {
    refuse(topic, "has " + std::to_string(info.d.size()) + " numbers of distortion", "calibrate the camera again");
  }
  camera.model = is_fisheye ? CameraModel::equidistant : CameraModel::radial_tangential;
  std::ranges::copy(numbers, camera.distortion.begin());
}

Camera camera_of(const ros::CameraInfo& info, bool is_rectified, const std::string& topic) {
  require_sense(info, topic);
  Camera camera;
  camera.width = static_cast<int>(info.width);
  camera.height = static_cast<int>(info.height);
  if (is_rectified) {
    camera.fx = info.p[0], camera.fy = info.p[5], camera.cx = info.p[2], camera.cy = info.p[6];
    if (!(camera.fx > 0.0 && camera.fy > 0.0)) refuse(topic, "has no P, which rectified images need", "fill in P");
    return camera;
  }
  camera.fx = info.k[0], camera.fy = info.k[4], camera.cx = info.k[2], camera.cy = info.k[5];
  set_distortion(camera, info, topic);
  return camera;
}

// R: the rectified frame's axes in those of the camera.
Eigen::Quaterniond rectified_from_camera(const ros::CameraInfo& info, bool is_rectified, const std::string& topic) {
  if (is_rectified) return Eigen::Quaterniond::Identity();
  const auto rotation =
      rotation_from_matrix(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(info.r.data()));
  if (!rotation) refuse(topic, "has an R that is no rotation", "calibrate the pair, or name a calibration file");
  return *rotation;
}

}  // namespace

Calibration calibration_of(const ros::CameraInfo& left, const std::optional<ros::CameraInfo>& right, bool is_rectified,
                           const CameraInfoTopics& topics) {
  Calibration calibration;
  calibration.left = camera_of(left, is_rectified, topics.left);
  if (!right) return calibration;
  const double fx = right->p[0];
  if (!(std::isfinite(right->p[3]) && fx > 0.0 && right->p[3] < 0.0)) {
    refuse(topics.right, "tells no baseline: the fourth number of P is not below zero",
           "calibrate the cameras as a pair, exchange left and right, or name a calibration file");
  }
  StereoPartner partner{camera_of(*right, is_rectified, topics.right), {}};
  const Eigen::Quaterniond left_turn = rectified_from_camera(left, is_rectified, topics.left);
  const Eigen::Quaterniond right_turn = rectified_from_camera(*right, is_rectified, topics.right);
  const Eigen::Vector3d shift(right->p[3] / fx, 0.0, 0.0);  // way of a point from the left to the right rectified frame
  partner.right_from_left = {(right_turn.conjugate() * left_turn).normalized(), right_turn.conjugate() * shift};
  calibration.right = partner;
  return calibration;
}

}  // namespace byre
