#include "byre/simulation/camera_imperfection.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/simulation/cowshed/feeding_robot.h"
#include "byre/simulation/rendered_room_scene.h"

#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::Not;

constexpr int kSeeds = 1000;

// Root mean square of a number over many errors.
double sigma_of(double level, const std::function<double(const CalibrationError&)>& number) {
  double sum = 0.0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const double value = number(draw_calibration_error(level, static_cast<std::uint64_t>(seed)));
    sum += value * value;
  }
  return std::sqrt(sum / kSeeds);
}

TEST(CalibrationError, IsZeroAtLevelZero) {
  const Calibration calibration = euroc_like_calibration(1);
  const Calibration told = perturbed(calibration, 0.0, 7);
  EXPECT_EQ(told.left.fx, calibration.left.fx);
  EXPECT_EQ(told.left.distortion, calibration.left.distortion);
  EXPECT_EQ(told.right->right_from_left.rotation.coeffs(), calibration.right->right_from_left.rotation.coeffs());
  EXPECT_EQ(draw_calibration_error(0.0, 7).right_rotation.norm(), 0.0);
}

TEST(CalibrationError, HasTheStandardDeviationsOfItsLevel) {
  constexpr double kTolerance = 0.08;  // relative: three standard errors of a thousand draws
  const auto expect_sigma = [&](double sigma, const std::function<double(const CalibrationError&)>& number) {
    EXPECT_NEAR(sigma_of(1.0, number) / sigma, 1.0, kTolerance);
    EXPECT_NEAR(sigma_of(3.0, number) / sigma, 3.0, 3.0 * kTolerance);
  };
  expect_sigma(4e-4, [](const CalibrationError& error) { return error.left.focal; });
  expect_sigma(0.15, [](const CalibrationError& error) { return error.right.centre.y(); });
  expect_sigma(1e-3, [](const CalibrationError& error) { return error.left.distortion[1]; });
  expect_sigma(1e-4, [](const CalibrationError& error) { return error.right.distortion[3]; });
  expect_sigma(0.01 * std::numbers::pi / 180.0, [](const CalibrationError& error) { return error.right_rotation.z(); });
  expect_sigma(1e-4, [](const CalibrationError& error) { return error.right_translation.x(); });
}

TEST(CalibrationError, IsDeterministicAndProportionalToItsLevel) {
  const CalibrationError good = draw_calibration_error(1.0, 5), again = draw_calibration_error(1.0, 5);
  const CalibrationError worn = draw_calibration_error(3.0, 5), other = draw_calibration_error(1.0, 6);
  EXPECT_EQ(good.left.focal, again.left.focal);
  EXPECT_EQ(good.right_rotation, again.right_rotation);
  EXPECT_NE(good.left.focal, other.left.focal);
  EXPECT_NEAR(worn.left.focal, 3.0 * good.left.focal, 1e-15);
  EXPECT_THAT(worn.right_rotation, PointNear(Eigen::Vector3d(3.0 * good.right_rotation), 1e-15));
}

TEST(CalibrationError, IsTheSameInAllRecordingsOfARobot) {
  const CalibrationError error = draw_calibration_error(1.0, 1);
  for (const Calibration& calibration : {euroc_like_calibration(1), feeding_robot_calibration(2)}) {
    const Calibration told = perturbed(calibration, 1.0, 1);
    EXPECT_NEAR(told.left.fx / calibration.left.fx, 1.0 + error.left.focal, 1e-12);
    EXPECT_NEAR(told.left.fy / calibration.left.fy, 1.0 + error.left.focal, 1e-12);
    EXPECT_NEAR(told.right->camera.cx - calibration.right->camera.cx, error.right.centre.x(), 1e-12);
    EXPECT_NEAR(told.left.distortion[0] - calibration.left.distortion[0], error.left.distortion[0], 1e-12);
    const Pose true_from_nominal =
        calibration.right->right_from_left * inverse(told.right->right_from_left);  // right camera's frames
    EXPECT_THAT(true_from_nominal,
                PoseNear(Pose{rotation_exp(error.right_rotation), error.right_translation}, 1e-12, 1e-12));
    EXPECT_THAT(told.body_from_left, PoseNear(calibration.body_from_left, 1e-12, 1e-12));
  }
}

TEST(CalibrationError, DistortsAPinholeCameraAndSkipsAMissingCamera) {
  Calibration calibration;
  calibration.left = {.width = 640, .height = 480, .fx = 500.0, .fy = 500.0, .cx = 319.5, .cy = 239.5};
  const Calibration told = perturbed(calibration, 1.0, 1);
  EXPECT_EQ(told.left.model, CameraModel::radial_tangential);
  EXPECT_THAT(std::vector<double>(told.left.distortion.begin(), told.left.distortion.begin() + 4), Each(Not(0.0)));
  EXPECT_FALSE(told.right);
}

// Level 1 matches the reprojection error that calibration tools report; level 3 is several times larger.
TEST(CalibrationError, MovesPixelsByTenthsAtLevelOne) {
  const Camera camera = euroc_like_calibration(1).left;
  const auto moved = [&](double level) {
    double sum = 0.0;
    int count = 0;
    for (std::uint64_t seed = 1; seed <= 30; ++seed) {
      const Camera told = perturbed(euroc_like_calibration(1), level, seed).left;
      for (double u = 60.0; u < camera.width; u += 90.0) {
        const Eigen::Vector3d ray = camera.bearing({u, 0.5 * u}).value();
        sum += (told.project(ray).value() - camera.project(ray).value()).squaredNorm();
        ++count;
      }
    }
    return std::sqrt(sum / count);
  };
  EXPECT_GT(moved(1.0), 0.15);
  EXPECT_LT(moved(1.0), 0.45);
  EXPECT_NEAR(moved(3.0), 3.0 * moved(1.0), 0.1 * moved(1.0));
}

}  // namespace
}  // namespace byre
