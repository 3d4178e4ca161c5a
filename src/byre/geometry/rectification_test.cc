#include "byre/geometry/rectification.h"

#include "byre/geometry/calibration_scene.h"
#include "byre/input_error.h"

#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

Eigen::Quaterniond turned(double degrees) {
  return rotation_exp({0.0, 0.0, degrees * std::numbers::pi / 180.0});
}

Calibration pair(const Pose& left_from_right) {
  Calibration calibration = scene_calibration();
  calibration.right->right_from_left = inverse(left_from_right);
  return calibration;
}

// Rows are equal, and the disparity is that of the depth, for points in view.
void expect_rectified(const Calibration& calibration) {
  const Rectification rectification = rectification_of(calibration);
  const Rig& rig = rectification.rig;
  int seen = 0;
  for (const double x : {-0.4, -0.2, 0.0, 0.2, 0.4}) {
    for (const double y : {-0.3, 0.0, 0.3}) {
      const Eigen::Vector3d point = 2.0 * Eigen::Vector3d(x, y, 1.0);
      if (!calibration.right->camera.project(calibration.right->right_from_left * point)) continue;
      const Eigen::Vector4d measurement = measured(calibration, calibration, rectification, point);
      if (!rig.contains(measurement.head<2>())) continue;
      ++seen;
      const double depth = (rectification.left_from_rectified.conjugate() * point).z();
      EXPECT_NEAR(measurement[2], rig.focal * rig.baseline / depth, 1e-6);
      EXPECT_NEAR(measurement[3], 0.0, 1e-6);
    }
  }
  EXPECT_GE(seen, 5);
}

TEST(Rectification, AlignsRows) {
  expect_rectified(scene_calibration());
  EXPECT_EQ(rectification_of(scene_calibration()).rig.width, scene_calibration().left.width);
}

TEST(Rectification, TurnsARightCameraThatIsUpsideDown) {
  const Calibration calibration = pair({turned(180.0), {0.11, 0.001, 0.0}});
  expect_rectified(calibration);
  const Rig upright = rectification_of(pair({turned(0.0), {0.11, 0.001, 0.0}})).rig;
  EXPECT_NEAR(rectification_of(calibration).rig.focal, upright.focal, 0.1 * upright.focal);
}

TEST(Rectification, TurnsCamerasAboveEachOtherByAQuarter) {
  for (const double down : {0.11, -0.11}) {
    for (const double roll : {0.0, 180.0, 3.0}) {
      const Calibration calibration = pair({turned(roll), {0.002, down, 0.0}});
      expect_rectified(calibration);
      const Rig rig = rectification_of(calibration).rig;
      EXPECT_EQ(rig.width, calibration.left.height);
      EXPECT_EQ(rig.height, calibration.left.width);
    }
  }
  Calibration rolling = pair({turned(0.0), {0.0, 0.11, 0.0}});
  rolling.readout_time = 0.02;
  EXPECT_THROW(rectification_of(rolling), InputError);
}

TEST(Rectification, TurnsOneCameraOnItsSide) {
  expect_rectified(pair({turned(90.0), {0.11, 0.0, 0.0}}));
  expect_rectified(pair({turned(-90.0), {0.11, 0.0, 0.0}}));
}

TEST(Rectification, RejectsExchangedCamerasAndABaselineAlongTheAxis) {
  const auto error = [](const Eigen::Vector3d& translation) -> std::string {
    try {
      rectification_of(pair({turned(0.0), translation}));
    } catch (const InputError& failure) {
      return failure.what();
    }
    return "none";
  };
  EXPECT_THAT(error({-0.11, 0.0, 0.0}), HasSubstr("is not to the right of the left camera (exchange left and right"));
  EXPECT_THAT(error({0.0, 0.01, 0.11}), HasSubstr("is in front of the left camera or behind it"));
}

}  // namespace
}  // namespace byre
