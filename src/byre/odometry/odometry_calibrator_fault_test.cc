#include "byre/odometry/prior_scene.h"

#include <cmath>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Wheels with a track width 3 % too large, and a right wheel that is larger.
TEST(OdometryCalibrator, CompensatesSystematicWheelErrors) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const DriveSensors wrong{.turn_scale = 0.97, .turn_per_metre = 0.004};
  const OdometryCalibrator prior = followed(drive, wrong, 60.0, 72.0);
  ASSERT_TRUE(prior.wheels());
  EXPECT_NEAR(prior.wheels()->turn_errors.scale, 1.0 / 0.97, 0.003);
  EXPECT_NEAR(prior.wheels()->turn_errors.per_metre, -0.004, 0.0015);
  const BodyMotion measured = over(prior, 60.0, 70.0);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(drive, 60.0, 70.0));
  EXPECT_LT(error.tail<3>().norm(), 0.01);  // radians; the wheels are 0.05 off
  EXPECT_LT(error.head<3>().norm(), 0.05);  // metres, of 5
}

TEST(OdometryCalibrator, IncreasesTheCovarianceWhileWheelsSlip) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const DriveSensors lifted{.wheels = true, .gyroscope = true, .slip_from = 62.0, .slip_to = 65.0, .slip_turn = 0.03};
  const BodyMotion measured = over(followed(drive, lifted, 60.0, 72.0), 60.0, 70.0);
  const BodyMotion sound = over(followed(drive, {.wheels = true, .gyroscope = true}, 60.0, 72.0), 60.0, 70.0);
  const double variance = position_variance(measured.covariance);
  const double sound_variance = position_variance(sound.covariance);
  EXPECT_GT(variance, 25.0 * sound_variance);
  const Vector6 error = log_pose(inverse(measured.last_from_body) * true_motion(drive, 60.0, 70.0));
  EXPECT_LT(error.transpose() * measured.covariance.ldlt().solve(error), 12.6);  // within 95 %
}

// A lifted wheel measures a false turn, which must not be taken for a delay.
TEST(OdometryCalibrator, EstimatesTheDelayDespiteALiftedWheel) {
  const Drive drive{.base_from_body = camera_on_base(), .wheel_delay = 0.03, .noise = 0.001};
  const OdometryCalibrator prior = followed(drive, {.slip_from = 40.0, .slip_to = 43.0, .slip_turn = 0.03}, 60.0, 60.0);
  EXPECT_NEAR(prior.time_offset(), 0.03, 0.01);
  EXPECT_FALSE(prior.are_wheels_slipping());
}

TEST(OdometryCalibrator, RejectsWheelsWhileTheySlip) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  EXPECT_TRUE(followed(drive, {.slip_from = 50.0, .slip_to = 100.0}, 55.0, 55.0).are_wheels_slipping());
  const OdometryCalibrator after = followed(drive, {.slip_from = 50.0, .slip_to = 53.0}, 60.0, 60.0);
  EXPECT_FALSE(after.are_wheels_slipping());
  EXPECT_EQ(after.slips(), 1);
  EXPECT_NEAR(after.wheels()->metres_per_unit, 1.0, 0.01);
}

TEST(OdometryCalibrator, KeepsAMountingDespiteEarlySlip) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibration known = followed(drive, {}, 60.0, 60.0).calibration_to_store();
  const OdometryCalibrator prior = followed(drive, {.slip_from = 0.5, .slip_to = 3.5}, 12.0, 12.0, known);
  EXPECT_FALSE(prior.has_calibration_changed());
  EXPECT_FALSE(prior.are_wheels_slipping());
}

// A drive whose wheel pose restarts at the origin at the given times; dark from 60 s on.
OdometryCalibrator followed_through_resets(const std::vector<double>& resets, double end) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  OdometryCalibrator prior;
  std::mt19937 random(5);
  for (int step = 0; step * 0.01 < end; ++step) {
    const double t = step * 0.01;
    Pose origin;
    for (const double reset : resets) {
      if (t >= reset) origin = Drive::world_from_base(reset);
    }
    if (step % 2 == 0) prior.add(StampedPose{from_seconds(t), inverse(origin) * Drive::world_from_base(t)});
    if (step % 5 == 0) prior.note(from_seconds(t), t < 60.0 ? std::optional(drive.seen(t, random)) : std::nullopt);
  }
  return prior;
}

TEST(OdometryCalibrator, BridgesAJumpOfTheWheelsByTheEarlierVelocity) {
  const Drive drive{.base_from_body = camera_on_base()};
  const OdometryCalibrator prior = followed_through_resets({20.0, 65.02}, 72.0);
  EXPECT_EQ(prior.slips(), 0) << "a jump is not counted as slip";
  const auto across = prior.between(from_seconds(65.0), from_seconds(65.05));
  ASSERT_TRUE(across);
  const Pose truth = true_motion(drive, 65.0, 65.05);
  EXPECT_LT((across->last_from_body.translation - truth.translation).norm(), 0.005);
  EXPECT_GT(std::sqrt(across->covariance(0, 0)), truth.translation.norm()) << "its sigma covers its whole length";
  const BodyMotion all = over(prior, 60.0, 70.0);
  const Vector6 error = log_pose(inverse(all.last_from_body) * true_motion(drive, 60.0, 70.0));
  EXPECT_LT(error.transpose() * all.covariance.ldlt().solve(error), 12.6) << "within 95 %";
  ASSERT_EQ(prior.warnings().size(), 1U) << "one for both jumps";
}

// Errors of measured steps stay within their covariance, whatever wheels report.
TEST(OdometryCalibrator, CoversFaultyWheelSteps) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  std::mt19937 chance(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (const double size : {0.02, 0.3, 3.0, 300.0, 1e200}) {
    OdometryCalibrator prior;
    std::mt19937 random(5);
    for (int step = 0; step < 7000; ++step) {
      const double t = step * 0.01;
      Pose wheels = Drive::world_from_base(t);
      if (t > 60.0 && uniform(chance) > 0.6)
        wheels.translation += size * Eigen::Vector3d(uniform(chance), uniform(chance), 0.0);
      if (step % 2 == 0) prior.add(StampedPose{from_seconds(t), wheels});
      if (step % 5 != 0) continue;
      prior.note(from_seconds(t), t < 60.0 ? std::optional(drive.seen(t, random)) : std::nullopt);
      if (t < 60.0) continue;
      const auto motion = prior.between(from_seconds(t - 0.05), from_seconds(t));
      if (!motion) continue;
      ASSERT_TRUE(is_sound(*motion)) << size;
      const Pose truth = true_motion(drive, t - 0.05, t);
      const double error = (motion->last_from_body.translation - truth.translation).norm();
      EXPECT_LT(error, 0.12 + 2.8 * std::sqrt(motion->covariance(0, 0))) << size << " at " << t;
    }
  }
}

TEST(OdometryCalibrator, IgnoresAGyroscopeInDegreesPerSecond) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  MotionLimits limits;
  limits.max_turn_rate = 100.0;
  OdometryCalibrator prior(limits);
  std::mt19937 random(5);
  for (int step = 0; step < 3000; ++step) {
    const double t = step * 0.01;
    if (step % 2 == 0) prior.add(StampedPose{from_seconds(t), Drive::world_from_base(t)});
    prior.add(
        AngularRate{from_seconds(t), 57.2958 * (kBodyFromGyroscope.conjugate() * rate_of_body(drive, t) + kBias)});
    if (step % 5 == 0) prior.note(from_seconds(t), drive.seen(t, random));
  }
  EXPECT_FALSE(prior.gyroscope());
  EXPECT_EQ(prior.warnings().size(), 1U);
  EXPECT_TRUE(prior.wheels());
}

TEST(OdometryCalibrator, ReportsWheelsThatContradictAMetricScale) {
  struct Case {
    double metres_per_unit;
    bool is_reported;
    bool is_ignored;
  };
  for (const auto& [metres_per_unit, is_reported, is_ignored] :
       {Case{1.02, false, false}, Case{1.3, true, false}, Case{0.01, true, true}}) {
    const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = metres_per_unit, .noise = 0.0002};
    OdometryCalibrator prior;
    prior.set_metric();
    std::mt19937 random(5);
    for (int step = 0; step < 3000; ++step) {
      const double t = step * 0.01;
      if (step % 2 == 0) prior.add(drive.wheels(t));
      if (step % 5 == 0) prior.note(from_seconds(t), drive.seen(t, random));
    }
    EXPECT_EQ(!prior.warnings().empty(), is_reported) << metres_per_unit;
    EXPECT_EQ(!prior.wheels(), is_ignored) << metres_per_unit;
  }
}

}  // namespace
}  // namespace byre
