#include "byre/odometry/prior_scene.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

// A prior after a drive without gaps, with wheel stamps that equal their receive times.
OdometryCalibrator heard_until_now(const Drive& drive, double end) {
  OdometryCalibrator prior;
  std::mt19937 random(5);
  for (int step = 0; step * 0.01 <= end; ++step) {
    const double t = step * 0.01;
    if (step % 2 == 0) prior.add(StampedPose{from_seconds(t), Drive::world_from_base(t - drive.wheel_delay)});
    if (step % 5 == 0) prior.note(from_seconds(t), drive.seen(t, random));
  }
  return prior;
}

TEST(OdometryCalibrator, IsEmptyBeforeTheMountingIsEstimated) {
  const Drive drive{.base_from_body = camera_on_base()};
  const OdometryCalibrator prior = followed(drive, {}, 1.0, 2.0);
  EXPECT_FALSE(prior.wheels());
  EXPECT_FALSE(prior.between(from_seconds(1.0), from_seconds(1.05)));
}

TEST(OdometryCalibrator, EstimatesDelayAndScaleAndBridgesTheDark) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .wheel_delay = 0.07, .noise = 0.001};
  const OdometryCalibrator prior = followed(drive, {}, 60.0, 72.0);
  ASSERT_TRUE(prior.wheels());
  EXPECT_NEAR(prior.time_offset(), 0.07, 0.01);
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 0.37, 0.004);
  const BodyMotion measured = over(prior, 60.0, 70.0);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(drive, 60.0, 70.0));
  EXPECT_LT(error.head<3>().norm() * drive.metres_per_unit, 0.05);  // metres, of 5
  EXPECT_LT(error.tail<3>().norm(), 0.02);
  EXPECT_LT(error.transpose() * measured.covariance.ldlt().solve(error), 12.6);  // within 95 %
}

// The turns suffice only after the first estimates of the calibration.
TEST(OdometryCalibrator, EstimatesTheDelayOnAShortDrive) {
  const Drive drive{.base_from_body = camera_on_base(), .wheel_delay = 0.07, .noise = 0.001};
  EXPECT_NEAR(followed(drive, {}, 14.0, 14.0).time_offset(), 0.07, 0.015);
}

// Only a metric map shows errors of wheels.
TEST(OdometryCalibrator, DoesNotTakeTheNoiseOfOneCameraForErrorsOfWheels) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.03};
  for (const bool is_metric : {false, true}) {
    OdometryCalibrator prior;
    if (is_metric) prior.set_metric();
    std::mt19937 random(5);
    for (double t = 0.0; t < 60.0; t += 0.05) {
      prior.add(drive.wheels(t));
      prior.note(from_seconds(t), drive.seen(t, random));
    }
    ASSERT_TRUE(prior.wheels());
    EXPECT_EQ(prior.wheels()->translation_error > 0.03, is_metric);
  }
}

// Motions by a wrong focal length have other lengths.
TEST(OdometryCalibrator, IgnoresMotionsBeforeAChangeOfTheFocalLength) {
  constexpr double kRefined = 40.0;  // seconds
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  Drive distorted = drive;
  distorted.metres_per_unit = 1.3;
  OdometryCalibrator prior;
  std::mt19937 random(5);
  for (double t = 0.0; t < 60.0; t += 0.05) {
    prior.add(drive.wheels(t));
    prior.set_focal_change(t < kRefined ? 1.0 : 0.88);
    prior.note(from_seconds(t), (t < kRefined ? distorted : drive).seen(t, random));
  }
  ASSERT_TRUE(prior.wheels());
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 1.0, 0.01);
}

// The final poses are those of 30 ms later.
TEST(OdometryCalibrator, EstimatesTheDelayAnewFromTheFinalPoses) {
  const Drive drive{.base_from_body = camera_on_base(), .wheel_delay = 0.07, .noise = 0.001};
  OdometryCalibrator prior = followed(drive, {}, 60.0, 60.0);
  std::mt19937 random(5);
  Trajectory poses;
  for (int i = 0; i < 1190; ++i) poses.push_back({from_seconds(0.05 * i), drive.seen(0.05 * i + 0.03, random)});
  prior.reestimate(poses, true);
  EXPECT_NEAR(prior.time_offset(), 0.10, 0.01);
}

// Poses on the way are too rough for an estimate, and a delay hides the calibration from a first estimate at the end.
TEST(OdometryCalibrator, EstimatesAtTheEndWhatWasUnknownOnTheWay) {
  Drive drive{.base_from_body = camera_on_base(), .wheel_delay = 0.12, .noise = 0.2};
  OdometryCalibrator calibrator = followed(drive, {}, 8.0, 8.0);
  ASSERT_FALSE(calibrator.wheels());
  drive.noise = 0.001;
  std::mt19937 random(7);
  Trajectory poses;
  for (int i = 0; i < 160; ++i) poses.push_back({from_seconds(0.05 * i), drive.seen(0.05 * i, random)});
  EXPECT_FALSE(calibrator.reestimate(poses, false)) << "determined";
  ASSERT_TRUE(calibrator.wheels());
  EXPECT_NEAR(calibrator.time_offset(), 0.12, 0.02);
  EXPECT_NEAR(calibrator.wheels()->base_from_body.translation.x(), 0.4, 0.05);
}

// A map that was finished without wheels may be bent, so that its poses determine the calibration roughly.
TEST(OdometryCalibrator, FinishesAgainWithARoughEstimate) {
  Drive drive{.base_from_body = camera_on_base(), .noise = 0.2};
  OdometryCalibrator calibrator = followed(drive, {}, 8.0, 8.0);
  drive.noise = 0.015;
  std::mt19937 random(7);
  Trajectory poses;
  for (int i = 0; i < 160; ++i) poses.push_back({from_seconds(0.05 * i), drive.seen(0.05 * i, random)});
  EXPECT_FALSE(calibrator.reestimate(poses, false));
  EXPECT_FALSE(calibrator.wheels());
  EXPECT_TRUE(calibrator.reestimate(poses, true));
  ASSERT_TRUE(calibrator.wheels());
  EXPECT_NEAR(calibrator.wheels()->metres_per_unit, 1.0, 0.3);
  EXPECT_FALSE(calibrator.reestimate(poses, false)) << "once";
}

// Wheel velocities at 50 Hz, with one gap in the stream while frames are tracked and one in the dark.
TEST(OdometryCalibrator, BridgesTheDarkByVelocities) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  OdometryCalibrator prior;
  std::mt19937 random(5);
  for (int step = 0; step < 7200; ++step) {
    const double t = step * 0.01;
    const bool is_lost = (t > 20.0 && t < 20.4) || (t > 68.0 && t < 69.0);
    if (step % 2 == 0 && !is_lost) prior.add(drive.velocity(t));
    if (step % 5 == 0) prior.note(from_seconds(t), t < 60.0 ? std::optional(drive.seen(t, random)) : std::nullopt);
  }
  ASSERT_TRUE(prior.wheels());
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 0.37, 0.004);
  EXPECT_EQ(prior.slips(), 0);
  const BodyMotion measured = over(prior, 60.0, 67.9);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(drive, 60.0, 67.9));
  EXPECT_LT(error.head<3>().norm() * drive.metres_per_unit, 0.05) << "metres, of 4";
  EXPECT_LT(error.transpose() * measured.covariance.ldlt().solve(error), 12.6) << "within 95 %";
  EXPECT_FALSE(prior.between(from_seconds(68.5), from_seconds(68.55))) << "in the gap";
  EXPECT_FALSE(prior.between(from_seconds(67.9), from_seconds(69.1))) << "across it";
  EXPECT_TRUE(prior.between(from_seconds(69.2), from_seconds(69.25)));
}

TEST(OdometryCalibrator, AppliesThePresentMountingToEarlierMotions) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  const OdometryCalibrator prior = followed(drive, {.gyroscope = true}, 60.0, 60.0);
  const auto measured = prior.path_between(from_seconds(2.0), from_seconds(3.0));
  ASSERT_TRUE(measured);
  const Vector6 error = log_pose(inverse(measured->last_from_body) * true_motion(drive, 2.0, 3.0));
  EXPECT_LT(error.head<3>().norm() * drive.metres_per_unit, 0.01);
  EXPECT_LT(error.tail<3>().norm(), 0.01);
}

TEST(OdometryCalibrator, LimitsTheReachByWheels) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  const OdometryCalibrator prior = followed(drive, {}, 30.0, 40.0);
  const auto reach = prior.reach(from_seconds(30.0), from_seconds(36.0), false);
  ASSERT_TRUE(reach);
  EXPECT_GT(*reach, true_motion(drive, 30.0, 36.0).translation.norm());
  EXPECT_LT(*reach * drive.metres_per_unit, 7.0);  // metres; the base went 3 m
  EXPECT_FALSE(prior.reach(from_seconds(36.0), from_seconds(50.0), false)) << "no wheel samples";
}

TEST(OdometryCalibrator, LimitsTheReachByWheelsOfUnknownMountingInAMetricMap) {
  const OdometryCalibrator prior = followed({.base_from_body = camera_on_base()}, {}, 1.0, 2.0);
  ASSERT_FALSE(prior.wheels());
  EXPECT_FALSE(prior.reach(from_seconds(1.0), from_seconds(1.9), false));
  const auto reach = prior.reach(from_seconds(1.0), from_seconds(1.9), true);
  ASSERT_TRUE(reach);
  EXPECT_GT(*reach, 0.45);
  EXPECT_LT(*reach, 3.5);
}

// An adjustment of the whole map may change the unit of a monocular map.
TEST(OdometryCalibrator, ReestimatesFromTheFinalMap) {
  Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  OdometryCalibrator prior = followed(drive, {}, 60.0, 60.0);
  drive.metres_per_unit = 0.38;
  std::mt19937 random(7);
  Trajectory seen;
  for (int i = 0; i < 600; ++i) seen.push_back({from_seconds(0.1 * i), drive.seen(0.1 * i, random)});
  prior.reestimate(seen, true);
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 0.38, 0.001);
}

// Poses computed from wheels are no evidence of their calibration.
TEST(OdometryCalibrator, ReestimatesFromTrackedPosesOnly) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  OdometryCalibrator prior = followed(drive, {}, 40.0, 60.0);
  Drive moved_camera = drive;
  moved_camera.base_from_body.translation.setZero();
  std::mt19937 random(7);
  Trajectory poses;
  for (int i = 0; i <= 1200; ++i) {
    const double t = 0.05 * i;
    poses.push_back({from_seconds(t), (t < 40.0 ? drive : moved_camera).seen(t, random)});
  }
  prior.reestimate(poses, true);
  EXPECT_NEAR(prior.wheels()->base_from_body.translation.x(), 0.4, 0.02);
}

// Wheel samples after the last frames have not arrived yet.
TEST(OdometryCalibrator, ContinuesTheLastMotionByWheels) {
  const Drive drive{.base_from_body = camera_on_base(), .wheel_delay = 0.15, .noise = 0.0005};
  const OdometryCalibrator late = heard_until_now(drive, 60.0);
  EXPECT_NEAR(late.time_offset(), 0.15, 0.01);
  const auto measured = late.between(from_seconds(59.95), from_seconds(60.0));
  ASSERT_TRUE(measured);
  const Vector6 error = log_pose(inverse(measured->last_from_body) * true_motion(drive, 59.95, 60.0));
  EXPECT_LT(error.head<3>().norm(), 0.005);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
}

// One camera begins its map late: frames are untracked for longer than samples are usually kept.
TEST(OdometryCalibrator, PropagatesBackToFramesBeforeTheMountingWasEstimated) {
  constexpr double kDark = 130.0, kEnd = 170.0, kFrame = 0.05;  // seconds
  const Drive drive{camera_on_base(), 3.0, 0.0, 0.0};
  OdometryCalibrator prior;
  std::mt19937 random(5);
  Trajectory seen;
  for (int i = 0; i * kFrame < kEnd; ++i) {
    const double t = i * kFrame;
    prior.add(drive.wheels(t));
    const Pose pose = drive.seen(t, random);
    if (t >= kDark) seen.push_back({from_seconds(t), pose});
    prior.note(from_seconds(t), t < kDark ? std::nullopt : std::optional(pose));
  }
  const Trajectory all = prior.fill_gaps(seen);
  ASSERT_EQ(all.size(), 3400u);
  for (const StampedPose& pose : all) {
    const Pose truth = drive.seen(to_seconds(pose.time), random);
    EXPECT_LT(3.0 * (pose.world_from_body.translation - truth.translation).norm(), 0.3) << to_seconds(pose.time);
  }
}

TEST(OdometryCalibrator, RotatesByTheGyroscope) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibrator prior = followed(drive, {.wheels = true, .gyroscope = true}, 60.0, 72.0);
  ASSERT_TRUE(prior.gyroscope());
  EXPECT_LT((prior.gyroscope()->bias - kBias).norm(), 0.003);
  const BodyMotion measured = over(prior, 60.0, 70.0);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(drive, 60.0, 70.0));
  EXPECT_LT(error.head<3>().norm(), 0.05);
  EXPECT_LT(error.tail<3>().norm(), 0.03);
}

TEST(OdometryCalibrator, ContinuesForASecondByTheGyroscopeAlone) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.0005};
  const OdometryCalibrator prior = followed(drive, {.wheels = false, .gyroscope = true}, 60.0, 72.0);
  ASSERT_TRUE(prior.between(from_seconds(60.0), from_seconds(60.05)));
  const Vector6 error = log_pose(inverse(over(prior, 60.0, 60.5).last_from_body) * true_motion(drive, 60.0, 60.5));
  EXPECT_LT(error.head<3>().norm(), 0.1);
  EXPECT_LT(error.tail<3>().norm(), 0.01);
  EXPECT_FALSE(prior.between(from_seconds(65.0), from_seconds(65.05)));
}

TEST(OdometryCalibrator, BridgesTheDarkFromTheStartWithAKnownMounting) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .wheel_delay = 0.07, .noise = 0.001};
  const DriveSensors sensors{.wheels = true, .gyroscope = true};
  const OdometryCalibration known = followed(drive, sensors, 60.0, 60.0).calibration_to_store();
  ASSERT_TRUE(known.wheels && known.gyroscope);
  EXPECT_FALSE(followed(drive, sensors, 1.0, 14.0).between(from_seconds(2.0), from_seconds(2.05))) << "without it";
  for (const double dark : {0.0, 1.0, 4.0}) {
    const OdometryCalibrator prior = followed(drive, sensors, dark, 14.0, known);
    const double from = dark + 0.2;  // wheel samples up to then have arrived
    ASSERT_TRUE(prior.between(from_seconds(from), from_seconds(from + 0.05))) << dark;
    const BodyMotion motion = over(prior, from, from + 8.0);
    const Vector6 error = log_pose(inverse(motion.last_from_body) * true_motion(drive, from, from + 8.0));
    EXPECT_LT(error.head<3>().norm() * drive.metres_per_unit, 0.05) << dark << ": metres, of 4";
    EXPECT_LT(error.tail<3>().norm(), 0.03) << dark;
    EXPECT_LT(error.transpose() * motion.covariance.ldlt().solve(error), 12.6) << dark << ": within 95 %";
    EXPECT_FALSE(prior.has_calibration_changed());
  }
}

// A tracking gap before the motions determine the calibration of wheels.
TEST(OdometryCalibrator, BridgesTheDarkByAPresumedMounting) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.001};
  const auto last_motion = [&](double dark, bool is_upright) {
    OdometryCalibrator prior;
    if (is_upright) prior.assume_upright(-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
    std::mt19937 random(5);
    for (int i = 0; i <= 60; ++i) {
      const double t = 0.05 * i;
      prior.add(drive.wheels(t));
      prior.note(from_seconds(t), t < dark ? std::optional(drive.seen(t, random)) : std::nullopt);
    }
    EXPECT_FALSE(prior.wheels());
    EXPECT_FALSE(prior.calibration_to_store().wheels);
    return prior.between(from_seconds(dark), from_seconds(3.0));
  };
  EXPECT_FALSE(last_motion(1.5, false));
  EXPECT_FALSE(last_motion(0.4, true));
  const auto measured = last_motion(1.5, true);
  ASSERT_TRUE(measured);
  const Vector6 error = log_pose(inverse(measured->last_from_body) * true_motion(drive, 1.5, 3.0));
  EXPECT_LT(error.head<3>().norm() * drive.metres_per_unit, 0.1);  // metres, of 0.75
  EXPECT_LT(error.tail<3>().norm(), 0.1);
  EXPECT_LT(error.transpose() * measured->covariance.ldlt().solve(error), 12.6);  // within 95 %
}

// Before the first tracked frame of a new map the length of the path is measured, its direction hardly.
TEST(OdometryCalibrator, MeasuresTheDistanceBeforeTheFirstFrameOfANewMap) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  for (const bool makes_map : {true, false}) {
    OdometryCalibrator prior;
    if (makes_map) prior.enable_mapping_mode();
    prior.assume_upright(-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
    for (int i = 0; i <= 40; ++i) {
      prior.add(drive.wheels(0.05 * i));
      prior.note(from_seconds(0.05 * i), {});
    }
    const auto measured = prior.between(from_seconds(0.5), from_seconds(1.5));
    ASSERT_EQ(measured.has_value(), makes_map);
    if (!measured) continue;
    const Pose truth = true_motion(drive, 0.5, 1.5);
    EXPECT_NEAR(measured->last_from_body.translation.norm(), truth.translation.norm(), 0.1);
    EXPECT_GT(measured->covariance(0, 0), 0.2 * truth.translation.squaredNorm());
    EXPECT_LT(angle_between(measured->last_from_body.rotation, truth.rotation), 0.05);
    std::mt19937 random(5);
    prior.note(from_seconds(2.05), drive.seen(2.05, random));
    EXPECT_FALSE(prior.between(from_seconds(0.5), from_seconds(1.5)))
        << "from here on tracked poses determine the mounting";
  }
}

// A turn alone shows the lever arm to a map in metres.
TEST(OdometryCalibrator, KnowsTheUnitOfAMapThatBeganByWheels) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  OdometryCalibrator prior;
  prior.enable_mapping_mode();
  prior.assume_upright(-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  std::mt19937 random(5);
  for (int i = 0; i <= 60; ++i) {
    const double t = 0.05 * i;
    prior.add(drive.wheels(t));
    if (i == 20) prior.begin_metric({from_seconds(0.0), from_seconds(t), true_motion(drive, 0.0, t)});
    prior.note(from_seconds(t), i >= 20 ? std::optional(drive.seen(t, random)) : std::nullopt);
    if (i == 21) EXPECT_FALSE(prior.calibration_to_store().wheels) << "assumed";
  }
  ASSERT_TRUE(prior.wheels());
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 1.0, 0.03);
  EXPECT_NEAR(prior.wheels()->base_from_body.translation.x(), 0.4, 0.15);
}

TEST(OdometryCalibrator, FollowsAScaledMap) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 2.0, .noise = 0.001};
  OdometryCalibrator prior = followed(drive, {}, 40.0, 50.0);
  const auto before = prior.between(from_seconds(45.0), from_seconds(46.0));
  prior.rescale(2.0);
  const auto after = prior.between(from_seconds(45.0), from_seconds(46.0));
  ASSERT_TRUE(before && after);
  EXPECT_NEAR(after->last_from_body.translation.norm(), 2.0 * before->last_from_body.translation.norm(), 1e-9);
  EXPECT_NEAR(prior.wheels()->metres_per_unit, 1.0, 0.02);
}

TEST(OdometryCalibrator, IsLessCertainUntilMotionsConfirmTheMounting) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibration known = followed(drive, {}, 60.0, 60.0).calibration_to_store();
  const auto variance = [&](double dark) {
    return followed(drive, {}, dark, 14.0, known)
        .between(from_seconds(dark + 0.2), from_seconds(dark + 0.25))
        .value()
        .covariance.trace();
  };
  EXPECT_GT(variance(0.0), 5.0 * variance(8.0));
}

TEST(OdometryCalibrator, DropsAChangedMounting) {
  const Drive before{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibration known = followed(before, {}, 60.0, 60.0).calibration_to_store();
  Drive turned = before;  // rotated far: hardly any motion agrees
  turned.base_from_body.rotation = rotation_exp({0.0, 0.0, 1.5}) * before.base_from_body.rotation;
  EXPECT_TRUE(followed(turned, {}, 8.0, 8.0, known).has_calibration_changed());
  Drive moved = before;  // moved little: no single motion shows it
  moved.base_from_body.translation.x() += 0.15;
  moved.base_from_body.translation.y() -= 0.1;
  const OdometryCalibrator prior = followed(moved, {}, 40.0, 52.0, known);
  EXPECT_TRUE(prior.has_calibration_changed());
  const BodyMotion measured = over(prior, 40.0, 50.0);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(moved, 40.0, 50.0));
  EXPECT_LT(error.head<3>().norm(), 0.06) << "metres, of 5";
  ASSERT_TRUE(prior.calibration_to_store().wheels);
  EXPECT_NEAR(prior.calibration_to_store().wheels->base_from_body.translation.x(), 0.55, 0.02);
}

// A focal length that is too long by a factor makes turns in images smaller by it.
TEST(OdometryCalibrator, ComparesTurnsInImagesWithThoseOfWheels) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  EXPECT_FALSE(followed(drive, {}, 2.0, 2.0).turn_ratio()) << "few turns";
  for (const double turn_scale : {1.0, 1.13}) {
    const auto ratio = followed(drive, {.turn_scale = turn_scale}, 60.0, 60.0).turn_ratio();
    ASSERT_TRUE(ratio);
    EXPECT_NEAR(ratio->value, 1.0 / turn_scale, 0.005);
    EXPECT_LT(ratio->sigma, 0.005);
  }
}

}  // namespace
}  // namespace byre
