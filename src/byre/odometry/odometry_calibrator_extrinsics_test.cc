#include "byre/odometry/prior_scene.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Contains;
using testing::Field;
using testing::HasSubstr;

// Extrinsics as by a tape measure, with this rotation error about the base's up axis.
WheelCalibration measured_by_hand(const Drive& drive, double yaw_error = 0.0) {
  WheelCalibration measured;
  measured.base_from_body = drive.base_from_body;
  measured.base_from_body.rotation = rotation_exp({0.0, 0.0, yaw_error}) * drive.base_from_body.rotation;
  measured.base_from_body.translation += Eigen::Vector3d(0.015, -0.01, 0.0);
  WheelDeviation sigmas;
  sigmas << 0.035, 0.035, 0.035, 0.02, 0.02, 0.02, 0.03, 0.03, 0.005;
  measured.covariance = sigmas.cwiseAbs2().asDiagonal();
  return measured;
}

struct Given {
  WheelCalibration measured;
  OdometryCalibration known{};  // from an earlier drive
  bool is_scale_unknown = false;
};

// A calibrator after a drive whose frames are tracked from `from` to `to`, seconds.
OdometryCalibrator driven(const Drive& drive, const Given& given, double from, double to, double end) {
  OdometryCalibrator calibrator;
  calibrator.begin_with(given.known);
  calibrator.begin_with_extrinsics(given.measured, {});
  calibrator.enable_mapping_mode();
  std::mt19937 random(5);
  bool is_begun = false;
  for (int i = 0; i * 0.05 <= end; ++i) {
    const double t = i * 0.05;
    calibrator.add(drive.wheels(t));
    const bool is_seen = t >= from && t < to;
    if (is_seen && !is_begun && given.is_scale_unknown) calibrator.forget_scale();
    is_begun = is_begun || is_seen;
    calibrator.note(from_seconds(t), is_seen ? std::optional(drive.seen(t, random)) : std::nullopt);
  }
  return calibrator;
}

TEST(GivenExtrinsics, YieldMotionFromTheFirstFrameOn) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive, 0.02)}, 1e9, 1e9, 5.0);
  const auto first = calibrator.between(from_seconds(0.0), from_seconds(0.05));
  ASSERT_TRUE(first);
  EXPECT_LT(log_pose(inverse(first->last_from_body) * true_motion(drive, 0.0, 0.05)).norm(), 0.01);
  const BodyMotion whole = over(calibrator, 0.0, 4.5);
  const Vector6 error = log_pose(inverse(whole.last_from_body) * true_motion(drive, 0.0, 4.5));
  EXPECT_LT(error.head<3>().norm(), 0.1) << "metres, of 2.25";
  EXPECT_LT(error.transpose() * whole.covariance.ldlt().solve(error), 12.6) << "within 95 %";
}

TEST(GivenExtrinsics, AreRefinedByDriving) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive, 0.03)}, 0.0, 60.0, 60.0);
  ASSERT_TRUE(calibrator.wheels());
  EXPECT_FALSE(calibrator.has_calibration_changed());
  EXPECT_LT(angle_between(calibrator.wheels()->base_from_body.rotation, drive.base_from_body.rotation), 0.01);
  EXPECT_LT((calibrator.wheels()->base_from_body.translation - drive.base_from_body.translation).head<2>().norm(),
            0.01);
}

TEST(GivenExtrinsics, AreReportedAndDroppedIfMotionsContradictThem) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  for (const double yaw_error : {0.3, 1.57, 3.1}) {
    const OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive, yaw_error)}, 0.0, 60.0, 60.0);
    EXPECT_TRUE(calibrator.has_calibration_changed()) << yaw_error;
    EXPECT_THAT(calibrator.warnings(),
                Contains(Field(&MotionWarning::what, HasSubstr("contradict the given extrinsics"))))
        << yaw_error;
    ASSERT_TRUE(calibrator.wheels()) << yaw_error;
    EXPECT_LT(angle_between(calibrator.wheels()->base_from_body.rotation, drive.base_from_body.rotation), 0.02)
        << yaw_error;
  }
}

TEST(GivenExtrinsics, ReplaceThoseOfTheMapOnlyIfTheyDiffer) {
  const Drive before{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibration known = followed(before, {}, 60.0, 60.0).calibration_to_store();
  Drive moved = before;
  moved.base_from_body.translation.x() += 0.3;
  const OdometryCalibrator agreeing = driven(before, {measured_by_hand(before), known}, 1e9, 1e9, 1.0);
  EXPECT_EQ(agreeing.wheels()->base_from_body.translation, known.wheels->base_from_body.translation);
  const OdometryCalibrator differing = driven(moved, {measured_by_hand(moved), known}, 1e9, 1e9, 1.0);
  EXPECT_NEAR(differing.wheels()->base_from_body.translation.x(), 0.715, 1e-9);
}

// One camera whose map began without measured motion.
TEST(GivenExtrinsics, DetermineTheUnitOfAMapFromTheFirstMotions) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  const OdometryCalibrator calibrator =
      driven(drive, {.measured = measured_by_hand(drive), .is_scale_unknown = true}, 2.0, 1e9, 5.0);
  ASSERT_TRUE(calibrator.wheels());
  EXPECT_NEAR(calibrator.wheels()->metres_per_unit, 0.37, 0.01);
}

// The unit of a map of one camera drifts from that of its first motion.
TEST(GivenExtrinsics, LeaveTheUnitOfTheFinalMapToItsMotions) {
  Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive)}, 0.0, 20.0, 20.0);
  drive.metres_per_unit = 1.4;
  std::mt19937 random(7);
  Trajectory final;
  for (int i = 0; i < 400; ++i) final.push_back({from_seconds(0.05 * i), drive.seen(0.05 * i, random)});
  calibrator.reestimate(final, true);
  EXPECT_NEAR(calibrator.wheels()->metres_per_unit, 1.4, 0.02);
}

// A map of one camera whose unit has changed half way: no scale is that of the whole map.
TEST(GivenExtrinsics, DoNotDetermineTheScaleOfAMapWhoseUnitDrifts) {
  for (const double drift : {1.0, 1.5}) {
    const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
    OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive)}, 0.0, 20.0, 20.0);
    Drive drifted = drive;
    drifted.metres_per_unit = drift;
    std::mt19937 random(7);
    Trajectory final;
    for (int i = 0; i < 400; ++i) {
      const Pose pose =
          i <= 200 ? drive.seen(0.05 * i, random)
                   : final[200].world_from_body * inverse(drifted.seen(10.0, random)) * drifted.seen(0.05 * i, random);
      final.push_back({from_seconds(0.05 * i), pose});
    }
    calibrator.reestimate(final, true);
    if (drift == 1.0) EXPECT_LT(calibrator.wheels()->scale_sigma(), 0.02);
    if (drift != 1.0) EXPECT_GT(calibrator.wheels()->scale_sigma(), 0.05);
  }
}

// Frames before the map begins, located in the finished map.
TEST(GivenExtrinsics, AreReestimatedByFramesLocatedLater) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  OdometryCalibrator calibrator = driven(drive, {measured_by_hand(drive)}, 9.0, 10.0, 10.0);
  std::mt19937 random(7);
  Trajectory final;
  std::vector<Timestamp> times;
  for (int i = 0; i < 200; ++i) {
    times.push_back(from_seconds(0.05 * i));
    final.push_back({times.back(), drive.seen(0.05 * i, random)});
  }
  calibrator.reestimate(final, true);
  const double before = calibrator.wheels()->arm_sigma();
  calibrator.note_located(times);
  calibrator.reestimate(final, true);
  EXPECT_LT(calibrator.wheels()->arm_sigma(), 0.5 * before);
}

// A drive too short for contradictions on the way: the final poses show them.
TEST(GivenExtrinsics, AreDroppedAtTheEndIfFinalPosesContradictThem) {
  for (const double error : {0.0, 0.3}) {  // metres, of the lever arm ahead
    const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
    WheelCalibration measured = measured_by_hand(drive);
    measured.base_from_body.translation.x() -= error;
    OdometryCalibrator calibrator = driven(drive, {measured}, 0.0, 4.0, 4.0);
    ASSERT_FALSE(calibrator.has_calibration_changed());
    std::mt19937 random(7);
    Trajectory final;
    for (int i = 0; i < 80; ++i) final.push_back({from_seconds(0.05 * i), drive.seen(0.05 * i, random)});
    EXPECT_EQ(calibrator.reestimate(final, true), error > 0.0);
    EXPECT_EQ(calibrator.has_calibration_changed(), error > 0.0);
    EXPECT_EQ(calibrator.warnings().size(), error > 0.0 ? 1u : 0u);
    ASSERT_TRUE(calibrator.wheels()) << error;
    EXPECT_NEAR(calibrator.wheels()->base_from_body.translation.x(), 0.4, 0.03) << error;
    EXPECT_FALSE(calibrator.reestimate(final, true)) << "dropped already";
  }
}

}  // namespace
}  // namespace byre
