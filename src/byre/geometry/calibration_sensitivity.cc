#include "byre/geometry/calibration_sensitivity.h"

#include <optional>

namespace byre {
namespace {

constexpr double kStep = 0.25;  // sigmas, of central differences

struct RectifiedCamera {
  const Camera& given;
  const Eigen::Quaterniond& camera_from_rectified;
  const Rig& rig;

  // Rectified pixel, by the given calibration, of a direction seen by a camera whose true calibration is `truth`.
  std::optional<Eigen::Vector2d> pixel_of(const Camera& truth, const Eigen::Vector3d& direction) const {
    const auto raw = truth.project(direction);
    const auto bearing = raw ? given.bearing(*raw) : std::nullopt;
    if (!bearing) return std::nullopt;
    return rig.project(camera_from_rectified.conjugate() * *bearing).head<2>();
  }
};

CalibrationVector step_along(int parameter, double sigmas) {
  CalibrationVector step = CalibrationVector::Zero();
  step[parameter] = sigmas;
  return step;
}

Eigen::Vector2d slope(const std::optional<Eigen::Vector2d>& after, const std::optional<Eigen::Vector2d>& before) {
  if (!after || !before) return Eigen::Vector2d::Zero();
  return (*after - *before) / (2.0 * kStep);
}

auto left_slopes(const Calibration& given, const Rectification& rectification) {
  return [&](const Eigen::Vector2d& pixel) {
    const RectifiedCamera camera{given.left, rectification.left_from_rectified, rectification.rig};
    const Eigen::Vector3d direction = rectification.left_from_rectified * rectification.rig.ray(pixel);
    Eigen::Matrix<double, 2, kParametersPerCamera> slopes;
    for (int i = 0; i < kParametersPerCamera; ++i) {
      slopes.col(i) = slope(camera.pixel_of(changed(given, step_along(kLeftCamera + i, kStep)).left, direction),
                            camera.pixel_of(changed(given, step_along(kLeftCamera + i, -kStep)).left, direction));
    }
    return slopes;
  };
}

auto right_slopes(const Calibration& given, const Rectification& rectification) {
  return [&](const Eigen::Vector2d& pixel) {
    Eigen::Matrix<double, 2, kCalibrationParameters - kRightCamera> slopes;
    slopes.setZero();
    if (!given.right) return slopes;
    const RectifiedCamera camera{given.right->camera, rectification.right_from_rectified, rectification.rig};
    const Eigen::Vector3d direction_in_left = given.right->right_from_left.rotation.conjugate() *
                                              (rectification.right_from_rectified * rectification.rig.ray(pixel));
    const auto seen = [&](int parameter, double step) {
      const StereoPartner right = *changed(given, step_along(parameter, step)).right;
      return camera.pixel_of(right.camera, right.right_from_left.rotation * direction_in_left);
    };
    for (int i = kRightCamera; i < kBaselineTurn; ++i)
      slopes.col(i - kRightCamera) = slope(seen(i, kStep), seen(i, -kStep));
    return slopes;
  };
}

// Derivatives of the right camera's centre by each parameter of the baseline rotation, in baselines.
Eigen::Matrix<double, 3, 2> centre_slopes(const Calibration& given, const Rectification& rectification) {
  Eigen::Matrix<double, 3, 2> slopes = Eigen::Matrix<double, 3, 2>::Zero();
  if (!given.right) return slopes;
  const auto centre = [&](int parameter, double step) -> Eigen::Vector3d {
    const Pose left_from_right = inverse(changed(given, step_along(parameter, step)).right->right_from_left);
    return rectification.left_from_rectified.conjugate() * left_from_right.translation / rectification.rig.baseline;
  };
  for (int i = 0; i < 2; ++i) {
    slopes.col(i) = (centre(kBaselineTurn + i, kStep) - centre(kBaselineTurn + i, -kStep)) / (2.0 * kStep);
  }
  return slopes;
}

}  // namespace

CalibrationSensitivity::CalibrationSensitivity(const Calibration& given)
    : CalibrationSensitivity(given, rectification_of(given)) {}

CalibrationSensitivity::CalibrationSensitivity(const Calibration& given, const Rectification& rectification)
    : rig_(rectification.rig),
      has_right_(given.right.has_value()),
      left_(rig_.width, rig_.height, left_slopes(given, rectification)),
      right_(rig_.width, rig_.height, right_slopes(given, rectification)),
      centre_by_turn_(centre_slopes(given, rectification)) {}

CalibrationSensitivity::Jacobian CalibrationSensitivity::at(const StereoPixel& pixel) const {
  Jacobian jacobian = Jacobian::Zero();
  const Eigen::Vector2d in_left = pixel.head<2>();
  const ByCamera by_left = left_.at(in_left);
  jacobian.block<2, kParametersPerCamera>(0, kLeftCamera) = by_left;
  if (!has_right_ || !(pixel.z() > 0.0)) return jacobian;
  const Eigen::Vector2d in_right(pixel.x() - pixel.z(), pixel.y());
  ByRightCamera by_right = right_.at(in_right);
  // A point at depth z moves in the image by -focal / z times the motion of the centre across the ray.
  const Eigen::Vector3d ray = rig_.ray(in_right);
  for (int i = 0; i < 2; ++i) {
    const Eigen::Vector3d centre = centre_by_turn_.col(i);
    by_right.col(kBaselineTurn - kRightCamera + i) = -pixel.z() * (centre.head<2>() - centre.z() * ray.head<2>());
  }
  jacobian.block<1, kParametersPerCamera>(2, kLeftCamera) = by_left.row(0);
  jacobian.block<1, kParametersPerCamera>(3, kLeftCamera) = -by_left.row(1);
  jacobian.block<1, kCalibrationParameters - kRightCamera>(2, kRightCamera) = -by_right.row(0);
  jacobian.block<1, kCalibrationParameters - kRightCamera>(3, kRightCamera) = by_right.row(1);
  return jacobian;
}

}  // namespace byre
