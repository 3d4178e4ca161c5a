#include "byre/geometry/calibration_sensitivity.h"

#include "byre/geometry/calibration_scene.h"
#include "byre/geometry/rectified_change.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// Points all over the image at depths from 0.5 to 8 m, in the rectified left camera.
std::vector<Eigen::Vector3d> points_in_view(const Rig& rig) {
  std::vector<Eigen::Vector3d> points;
  for (const double depth : {0.5, 2.0, 8.0}) {
    for (double v = 30.0; v < 460.0; v += 42.0) {
      for (double u = 140.0; u < 730.0; u += 58.0) points.push_back(depth * rig.ray({u, v}));
    }
  }
  return points;
}

TEST(CalibrationSensitivity, PredictsTheEffectOfACalibrationErrorOnAPoint) {
  const Calibration given = scene_calibration();
  const Rectification rectification = rectification_of(given);
  const CalibrationSensitivity sensitivity(given);
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const CalibrationVector error = draw_error(seed);
    const Calibration truth = changed(given, error);
    for (const Eigen::Vector3d& point : points_in_view(rectification.rig)) {
      const StereoPixel ideal = rectification.rig.project(point);
      const Eigen::Vector3d in_left = rectification.left_from_rectified * point;
      const Eigen::Vector4d expected =
          Eigen::Vector4d(ideal.x(), ideal.y(), ideal.z(), 0.0) + sensitivity.at(ideal) * error;
      EXPECT_LT((measured(truth, given, rectification, in_left) - expected).norm(), 0.02)
          << "seed " << seed << ", pixel " << ideal.transpose();
    }
  }
}

TEST(CalibrationSensitivity, IsZeroForOtherCameras) {
  Calibration given = scene_calibration();
  given.right.reset();
  const auto jacobian = CalibrationSensitivity(given).at({100.0, 100.0, -1.0});
  EXPECT_GT(jacobian.leftCols(kRightCamera).norm(), 0.1);
  EXPECT_EQ(jacobian.rightCols(kCalibrationParameters - kRightCamera).norm(), 0.0);
}

TEST(IsNominal, HoldsForNumbersOfDriversOnly) {
  Calibration given;
  given.left = {
      .model = CameraModel::pinhole, .width = 640, .height = 480, .fx = 570.34, .fy = 570.34, .cx = 314.5, .cy = 235.5};
  EXPECT_TRUE(is_nominal(given));
  Calibration other = given;
  other.left.fy = 571.2;
  EXPECT_FALSE(is_nominal(other)) << "measured pixels are not square";
  other = given;
  other.left.cx = 318.64;
  EXPECT_FALSE(is_nominal(other)) << "rectified images";
  other = given;
  other.left.model = CameraModel::radial_tangential;
  EXPECT_TRUE(is_nominal(other)) << "distortion of zeros";
  other.left.distortion[0] = 0.01;
  EXPECT_FALSE(is_nominal(other));
  other = given;
  other.depth = DepthCamera{};
  EXPECT_FALSE(is_nominal(other)) << "depth contradicts a wrong focal length already";
}

TEST(Changed, KeepsTheLengthOfTheBaseline) {
  const Calibration given = scene_calibration();
  const Calibration other = changed(given, draw_error(3, 5.0));
  EXPECT_NEAR(inverse(other.right->right_from_left).translation.norm(),
              inverse(given.right->right_from_left).translation.norm(), 1e-12);
}

TEST(Changed, EqualsTheCalibrationWithoutChange) {
  const Calibration given = scene_calibration();
  const Calibration same = changed(given, CalibrationVector::Zero());
  EXPECT_EQ(same.left, given.left);
  EXPECT_EQ(same.right->camera, given.right->camera);
}

TEST(RectifiedChange, MovesCornersToTheTrueCalibration) {
  const Calibration given = scene_calibration();
  const Calibration truth = changed(given, draw_error(7));
  const Rectification rectified_by_given = rectification_of(given), rectified_by_truth = rectification_of(truth);
  const RectifiedChange change(given, truth);
  for (const Eigen::Vector3d& point : points_in_view(rectified_by_truth.rig)) {
    const Eigen::Vector3d in_left = rectified_by_truth.left_from_rectified * point;
    const Eigen::Vector4d before = measured(truth, given, rectified_by_given, in_left);
    const RectifiedChange::Corner after = change({before.head<3>(), before.w()});
    const StereoPixel ideal = rectified_by_truth.rig.project(point);
    EXPECT_LT((after.pixel - ideal).norm(), 0.02) << ideal.transpose();
    EXPECT_NEAR(after.row_offset, 0.0, 0.02);
  }
}

TEST(RectifiedChange, RotatesTheRectifiedCameraAboutItsCentre) {
  const Calibration given = scene_calibration();
  const Calibration truth = changed(given, draw_error(7));
  const RectifiedChange change(given, truth);
  const Eigen::Vector3d in_left(0.3, -0.2, 2.0);
  const Eigen::Vector3d before = rectification_of(given).left_from_rectified.conjugate() * in_left;
  const Eigen::Vector3d after = rectification_of(truth).left_from_rectified.conjugate() * in_left;
  EXPECT_LT((change.after_from_before() * before - after).norm(), 1e-12);
}

}  // namespace
}  // namespace byre
