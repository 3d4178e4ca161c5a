#include "byre/geometry/calibration_change.h"
#include "byre/geometry/degrees.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

// Standard errors of a good calibration, as left by tools that report 0.1 to 0.2 px of reprojection error.
constexpr double kFocalSigma = 4e-4;         // relative
constexpr double kAspectSigma = 1e-4;        // relative, of fy / fx
constexpr double kCentreSigma = 0.15;        // pixels
constexpr double kRadialSigma = 1e-3;        // k1 and k2; k3 and k4 of a fisheye
constexpr double kTangentialSigma = 1e-4;    // p1 and p2
constexpr double kRotationSigma = 0.01;      // degrees
constexpr double kBaselineTurnSigma = 0.05;  // degrees: 0.1 mm across a baseline of 0.1 m

Camera changed(Camera camera, const double* sigmas) {
  const double focal = 1.0 + kFocalSigma * sigmas[kFocal];
  const double half_aspect = 1.0 + 0.5 * kAspectSigma * sigmas[kAspect];
  camera.fx *= focal / half_aspect;
  camera.fy *= focal * half_aspect;
  camera.cx += kCentreSigma * sigmas[kCentreU];
  camera.cy += kCentreSigma * sigmas[kCentreV];
  const double* const distortion = sigmas + kFirstDistortion;
  const bool is_distorted = std::any_of(distortion, distortion + 4, [](double value) { return value != 0.0; });
  if (camera.model == CameraModel::pinhole && is_distorted) camera.model = CameraModel::radial_tangential;
  for (int i = 0; i < 4; ++i) {
    const bool is_tangential = camera.model != CameraModel::equidistant && i >= 2;
    camera.distortion[static_cast<std::size_t>(i)] += (is_tangential ? kTangentialSigma : kRadialSigma) * distortion[i];
  }
  return camera;
}

// Rotates the right camera about its own centre; rotation vector in its own frame.
Pose turned(const Pose& right_from_left, const Eigen::Vector3d& rotation) {
  return Pose{rotation_exp(-rotation), Eigen::Vector3d::Zero()} * right_from_left;
}

// Moves the right camera's centre about the left one by two small angles. Distance and orientation are kept.
Pose carried_round(const Pose& right_from_left, double about_z, double about_y) {
  const Eigen::Vector3d centre = inverse(right_from_left).translation;
  const Eigen::Vector3d along = centre.normalized();
  const Eigen::Vector3d forward = (Eigen::Vector3d::UnitZ() - along.z() * along).normalized();
  const Eigen::Vector3d down = forward.cross(along);
  const Eigen::Vector3d carried = centre.norm() * (along + about_z * down - about_y * forward).normalized();
  return {right_from_left.rotation, -(right_from_left.rotation * carried)};
}

}  // namespace

const std::array<CalibrationParameter, kCalibrationParameters>& calibration_parameters() {
  static constexpr std::array<CalibrationParameter, kCalibrationParameters> kParameters = {{
      {"left focal length", "%", 100.0 * kFocalSigma},
      {"left aspect", "%", 100.0 * kAspectSigma},
      {"left principal point u", "px", kCentreSigma},
      {"left principal point v", "px", kCentreSigma},
      {"left distortion 1", "", kRadialSigma},
      {"left distortion 2", "", kRadialSigma},
      {"left distortion 3", "", kTangentialSigma},
      {"left distortion 4", "", kTangentialSigma},
      {"right focal length", "%", 100.0 * kFocalSigma},
      {"right aspect", "%", 100.0 * kAspectSigma},
      {"right principal point u", "px", kCentreSigma},
      {"right principal point v", "px", kCentreSigma},
      {"right distortion 1", "", kRadialSigma},
      {"right distortion 2", "", kRadialSigma},
      {"right distortion 3", "", kTangentialSigma},
      {"right distortion 4", "", kTangentialSigma},
      {"right camera rotation about x", "deg", kRotationSigma},
      {"right camera rotation about y", "deg", kRotationSigma},
      {"right camera rotation about z", "deg", kRotationSigma},
      {"baseline rotation about z", "deg", kBaselineTurnSigma},
      {"baseline rotation about y", "deg", kBaselineTurnSigma},
  }};
  return kParameters;
}

bool is_nominal(const Calibration& calibration) {
  const Camera& camera = calibration.left;
  const auto is_half = [](double pixel) { return std::abs(2.0 * pixel - std::round(2.0 * pixel)) < 1e-6; };
  const bool is_distorted = std::ranges::any_of(camera.distortion, [](double value) { return value != 0.0; });
  const bool may_be_without = camera.model == CameraModel::pinhole || camera.model == CameraModel::radial_tangential;
  return !calibration.is_metric() && may_be_without && !is_distorted && camera.fx == camera.fy && is_half(camera.cx) &&
         is_half(camera.cy);
}

bool has_parameter(const Calibration& calibration, int parameter) {
  return parameter < kRightCamera || calibration.right.has_value();
}

Calibration changed(const Calibration& calibration, const CalibrationVector& sigmas) {
  Calibration result = calibration;
  result.left = changed(calibration.left, sigmas.data() + kLeftCamera);
  if (!calibration.right) return result;
  result.right->camera = changed(calibration.right->camera, sigmas.data() + kRightCamera);
  const Pose turned_right =
      turned(calibration.right->right_from_left, kRotationSigma * kDegree * sigmas.segment<3>(kRightRotation));
  result.right->right_from_left = carried_round(turned_right, kBaselineTurnSigma * kDegree * sigmas[kBaselineTurn],
                                                kBaselineTurnSigma * kDegree * sigmas[kBaselineTurn + 1]);
  return result;
}

}  // namespace byre
