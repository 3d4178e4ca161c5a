#include "byre/simulation/calibration_error.h"

#include "byre/simulation/seeded_draws.h"

#include <algorithm>
#include <numbers>

namespace byre {
namespace {

constexpr double kFocalSigma = 4e-4;
constexpr double kCentreSigma = 0.15;  // pixels
constexpr std::array<double, 4> kDistortionSigmas{1e-3, 1e-3, 1e-4, 1e-4};
constexpr double kTurnSigma = 0.01 * std::numbers::pi / 180.0;  // radians
constexpr double kMoveSigma = 1e-4;                             // metres

class NormalDraws {
 public:
  NormalDraws(double level, std::uint64_t seed) : level_(level), draws_(seed, 61) {}

  // Approximately normal: the sum of twelve uniform numbers has variance 1.
  double operator()(double sigma) {
    double sum = 0.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(draws_.between(-0.5f, 0.5f));
    return level_ * sigma * sum;
  }

 private:
  double level_;
  SeededDraws draws_;
};

CameraError draw_camera_error(NormalDraws& normal) {
  CameraError error;
  error.focal = normal(kFocalSigma);
  for (double& pixels : error.centre) pixels = normal(kCentreSigma);
  for (std::size_t i = 0; i < kDistortionSigmas.size(); ++i) error.distortion[i] = normal(kDistortionSigmas[i]);
  return error;
}

Camera perturbed(Camera camera, const CameraError& error) {
  camera.fx *= 1.0 + error.focal;
  camera.fy *= 1.0 + error.focal;
  camera.cx += error.centre.x();
  camera.cy += error.centre.y();
  const bool has_lens = std::ranges::any_of(error.distortion, [](double value) { return value != 0.0; });
  if (has_lens && camera.model == CameraModel::pinhole) camera.model = CameraModel::radial_tangential;
  for (std::size_t i = 0; i < error.distortion.size(); ++i) camera.distortion[i] += error.distortion[i];
  return camera;
}

}  // namespace

CalibrationError draw_calibration_error(double level, std::uint64_t seed) {
  NormalDraws normal(level, seed);
  CalibrationError error{draw_camera_error(normal), draw_camera_error(normal)};
  for (double& radians : error.right_rotation) radians = normal(kTurnSigma);
  for (double& metres : error.right_translation) metres = normal(kMoveSigma);
  return error;
}

Calibration perturbed(const Calibration& calibration, const CalibrationError& error) {
  Calibration result = calibration;
  result.left = perturbed(calibration.left, error.left);
  if (calibration.right) {
    const Pose true_from_nominal{rotation_exp(error.right_rotation), error.right_translation};  // right camera's frames
    result.right = StereoPartner{perturbed(calibration.right->camera, error.right),
                                 inverse(true_from_nominal) * calibration.right->right_from_left};
  }
  return result;
}

Calibration perturbed(const Calibration& calibration, double level, std::uint64_t seed) {
  return level == 0.0 ? calibration : perturbed(calibration, draw_calibration_error(level, seed));
}

}  // namespace byre
