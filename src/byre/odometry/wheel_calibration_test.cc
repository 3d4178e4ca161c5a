#include "byre/odometry/wheel_calibration.h"

#include "byre/odometry/drive_scene.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

std::vector<MotionPair> pairs_of(const Drive& drive, double seconds) {
  std::mt19937 random(3);
  std::vector<MotionPair> pairs;
  for (double t = 0.0; t < seconds; t += 0.5) {
    pairs.push_back({inverse(Drive::world_from_base(t)) * Drive::world_from_base(t + 0.5),
                     inverse(drive.seen(t, random)) * drive.seen(t + 0.5, random)});
  }
  return pairs;
}

WheelCalibration upright() {
  return upright_wheel_calibration(-Eigen::Vector3d::UnitY(), 0.2);
}

void expect_near(const WheelCalibration& calibration, const Drive& drive, double metres, double radians, double share) {
  EXPECT_LT((calibration.base_from_body.translation - drive.base_from_body.translation).norm(), metres);
  EXPECT_LT(angle_between(calibration.base_from_body.rotation, drive.base_from_body.rotation), radians);
  EXPECT_NEAR(calibration.metres_per_unit, drive.metres_per_unit, share * drive.metres_per_unit);
}

TEST(WheelCalibration, IsExactWithoutNoise) {
  for (const double metres_per_unit : {1.0, 0.37, 12.0}) {
    const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = metres_per_unit};
    const auto calibration = estimate_wheel_calibration(pairs_of(drive, 30.0));
    ASSERT_TRUE(calibration);
    expect_near(*calibration, drive, 1e-5, 1e-6, 1e-6);
  }
}

TEST(WheelCalibration, IsRobustToNoiseAndSlip) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.002};
  std::vector<MotionPair> pairs = pairs_of(drive, 60.0);
  for (std::size_t i = 0; i < pairs.size(); i += 5) pairs[i].base.translation *= 3.0;
  const auto calibration = estimate_wheel_calibration(pairs);
  ASSERT_TRUE(calibration);
  expect_near(*calibration, drive, 0.01, 0.02, 0.01);
  EXPECT_LT(calibration->scale_sigma(), 0.01);
}

TEST(WheelCalibration, PredictsTheMotionOfTheBody) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37};
  const auto calibration = estimate_wheel_calibration(pairs_of(drive, 30.0));
  ASSERT_TRUE(calibration);
  std::mt19937 random(3);
  const Pose seen = inverse(drive.seen(40.0, random)) * drive.seen(43.0, random);
  const Pose measured = body_motion(*calibration, inverse(Drive::world_from_base(40.0)) * Drive::world_from_base(43.0));
  EXPECT_LT((measured.translation - seen.translation).norm(), 1e-4);
  EXPECT_LT(angle_between(measured.rotation, seen.rotation), 1e-5);
}

// An omnidirectional base that drives ahead, to the left and turns independently. Its rollers slip: it moves less far
// sideways than they measure.
std::vector<MotionPair> pairs_of_omni(const Drive& drive, double seconds, double told_of_side, double turning,
                                      double ahead) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0.0, 0.001);
  std::vector<MotionPair> pairs;
  for (double t = 0.0; t < seconds; t += 0.5) {
    const Pose true_base{rotation_exp({0.0, 0.0, turning * std::sin(0.4 * t)}),
                         {ahead * std::cos(0.31 * t), 0.2 * std::sin(0.53 * t + 0.8), 0.0}};
    MotionPair pair{true_base, inverse(drive.base_from_body) * true_base * drive.base_from_body};
    pair.base.translation.y() *= told_of_side;
    for (int axis = 0; axis < 3; ++axis) pair.body.translation[axis] += noise(random);
    pairs.push_back(pair);
  }
  return pairs;
}

TEST(WheelCalibration, IsEstimatedForAnOmnidirectionalBase) {
  const Drive drive{.base_from_body = camera_on_base()};
  for (const double ahead : {0.2, 0.0}) {
    const auto calibration = estimate_wheel_calibration(pairs_of_omni(drive, 60.0, 1.0, 0.2, ahead));
    ASSERT_TRUE(calibration) << ahead;
    expect_near(*calibration, drive, 0.005, 0.01, 0.005);
    const auto assumed = estimate_wheel_calibration(pairs_of_omni(drive, 3.0, 1.0, 0.0, ahead), upright());
    ASSERT_TRUE(assumed) << ahead;
    EXPECT_LT(angle_between(assumed->base_from_body.rotation, drive.base_from_body.rotation), 0.15) << ahead;
  }
}

TEST(WheelCalibration, EstimatesTheSidewaysError) {
  const Drive drive{.base_from_body = camera_on_base()};
  for (const double ahead : {0.2, 0.6}) {  // the faster it drives ahead, the smaller the effect of the sideways error
    const auto calibration = estimate_wheel_calibration(pairs_of_omni(drive, 60.0, 1.15, 0.2, ahead));
    ASSERT_TRUE(calibration);
    const Pose measured = body_motion(*calibration, {Eigen::Quaterniond::Identity(), {0.0, 1.15, 0.0}});
    const Eigen::Vector3d truth = drive.base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitY();
    EXPECT_GT((measured.translation - truth).norm(), 0.05);
    EXPECT_LT((measured.translation - truth).norm(), 2.5 * calibration->lateral_error) << ahead;
  }
  EXPECT_LT(estimate_wheel_calibration(pairs_of_omni(drive, 60.0, 1.0, 0.2, 0.2))->lateral_error, 0.03);
  const auto never_across = estimate_wheel_calibration(pairs_of(drive, 30.0));
  ASSERT_TRUE(never_across);
  EXPECT_EQ(never_across->lateral_error, 0.2) << "no sideways motion was observed";
}

TEST(WheelCalibration, IsEmptyWithoutTurning) {
  MotionPair ahead;
  ahead.base.translation.x() = ahead.body.translation.z() = 0.25;
  const std::vector<MotionPair> pairs(60, ahead);
  EXPECT_FALSE(estimate_wheel_calibration(pairs));
}

TEST(WheelCalibration, IsEmptyWithoutDriving) {
  const Drive drive{.base_from_body = camera_on_base()};
  std::vector<MotionPair> pairs = pairs_of(drive, 30.0);
  for (MotionPair& pair : pairs) pair.base.translation.setZero();
  EXPECT_FALSE(estimate_wheel_calibration(pairs));
}

TEST(WheelCalibration, IsPresumedAfterASecondOfMotion) {
  for (const double metres_per_unit : {1.0, 0.37, 12.0}) {
    Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = metres_per_unit, .noise = 0.001};
    drive.base_from_body.rotation = drive.base_from_body.rotation * rotation_exp({0.3, 0.0, 0.0});  // looks down
    const std::vector<MotionPair> pairs = pairs_of(drive, 1.5);
    const auto calibration = estimate_wheel_calibration(pairs, upright());
    ASSERT_TRUE(calibration);
    EXPECT_LT(angle_between(calibration->base_from_body.rotation, drive.base_from_body.rotation), 0.15);
    EXPECT_NEAR(calibration->metres_per_unit, metres_per_unit, 0.05 * metres_per_unit);
  }
}

// Turns determine the axis in the end, whatever was assumed.
TEST(WheelCalibration, IsPresumedFromTurnsOfATiltedCamera) {
  Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  drive.base_from_body.rotation = drive.base_from_body.rotation * rotation_exp({0.0, 0.0, 1.5});  // lies on its side
  const auto calibration = estimate_wheel_calibration(pairs_of(drive, 8.0), upright());
  ASSERT_TRUE(calibration);
  EXPECT_LT(angle_between(calibration->base_from_body.rotation, drive.base_from_body.rotation), 0.1);
}

TEST(WheelCalibration, IsPresumedForwardBeforeTracking) {
  const Drive drive{.base_from_body = camera_on_base()};
  const auto calibration = forward_facing_calibration(-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(calibration);
  EXPECT_LT(angle_between(calibration->base_from_body.rotation, drive.base_from_body.rotation), 0.15);
  EXPECT_EQ(calibration->heading_sigma(), 1.0) << "the camera may face sideways";
  EXPECT_FALSE(forward_facing_calibration(-Eigen::Vector3d::UnitY(), Eigen::Vector3d(0.0, -1.0, 0.1)))
      << "an upward camera does not determine the forward direction";
}

// Before the first turn, only an accelerometer detects a camera that lies on its side.
TEST(WheelCalibration, IsPresumedFromAMeasuredUpDirectionForASidewaysCamera) {
  Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  drive.base_from_body.rotation = drive.base_from_body.rotation * rotation_exp({0.0, 0.0, 1.5});
  const std::vector<MotionPair> pairs = pairs_of(drive, 1.5);
  const auto error = [&](const Eigen::Vector3d& up, double tilt_sigma) {
    const auto calibration = estimate_wheel_calibration(pairs, upright_wheel_calibration(up, tilt_sigma));
    return calibration ? angle_between(calibration->base_from_body.rotation, drive.base_from_body.rotation) : 10.0;
  };
  const Eigen::Vector3d up = drive.base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_LT(error(rotation_exp({0.01, 0.0, 0.01}) * up, 0.03), 0.15);
  EXPECT_GT(error(-Eigen::Vector3d::UnitY(), 0.2), 0.2);
}

// A prior as narrow as a tape measure, and a drive that does not turn.
TEST(WheelCalibration, StaysAtThePriorInWhatMotionsLeaveOpen) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 3.0};
  WheelCalibration prior;
  prior.base_from_body = drive.base_from_body;
  WheelDeviation sigmas;
  sigmas << 0.035, 0.035, 0.035, 0.02, 0.02, 0.02, 1.0, 0.03, 0.005;
  prior.covariance = sigmas.cwiseAbs2().asDiagonal();
  const Eigen::Vector3d ahead_in_body = drive.base_from_body.rotation.conjugate() * Eigen::Vector3d(0.5, 0.0, 0.0);
  const MotionPair ahead{{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}},
                         {Eigen::Quaterniond::Identity(), ahead_in_body / 3.0}};
  const auto found = estimate_wheel_calibration(std::vector<MotionPair>(4, ahead), prior);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->metres_per_unit, 3.0, 0.001);
  EXPECT_LT(found->scale_sigma(), 0.02);
  EXPECT_LT(found->heading_sigma(), 0.02) << "by the direction of motion";
  EXPECT_NEAR(std::sqrt(found->covariance(0, 0)), 0.035, 0.001) << "roll shows only in turns";
  EXPECT_NEAR(found->arm_sigma(), 0.02 * std::sqrt(2.0), 0.001) << "the lever arm shows only in turns";
}

// Sensitivity of the posterior by random priors: the true mounting is within the sigmas of the estimate.
TEST(WheelCalibration, HasTheCovarianceOfItsErrors) {
  std::mt19937 random(11);
  std::normal_distribution<double> normal;
  int inside = 0;
  constexpr int kDrives = 100;
  for (int i = 0; i < kDrives; ++i) {
    const Drive drive{.base_from_body = camera_on_base()};
    WheelDeviation sigmas;
    sigmas << 0.035, 0.035, 0.035, 0.02, 0.02, 0.02, 0.03, 0.03, 0.005;
    WheelCalibration prior;
    prior.covariance = sigmas.cwiseAbs2().asDiagonal();
    WheelDeviation error;
    for (int k = 0; k < 9; ++k) error[k] = sigmas[k] * normal(random);
    error.tail<2>().setZero();
    prior.base_from_body.rotation = rotation_exp(error.head<3>()) * drive.base_from_body.rotation;
    prior.base_from_body.translation = drive.base_from_body.translation + error.segment<3>(3);
    prior.metres_per_unit = std::exp(error[6]);
    const auto found = estimate_wheel_calibration(pairs_of(drive, 2.0), prior);
    ASSERT_TRUE(found);
    WheelCalibration truth = prior;
    truth.base_from_body = drive.base_from_body;
    truth.metres_per_unit = 1.0;
    const WheelDeviation apart = difference(*found, truth);
    if (apart.dot(found->covariance.ldlt().solve(apart)) < 16.9) ++inside;  // 95 % of nine parameters
  }
  EXPECT_GE(inside, 90);
}

TEST(WheelCalibration, IsNotPresumedFromTurningOnTheSpot) {
  const Drive drive{.base_from_body = camera_on_base()};
  std::vector<MotionPair> pairs = pairs_of(drive, 3.0);
  for (MotionPair& pair : pairs) pair.base.translation.setZero();
  EXPECT_FALSE(estimate_wheel_calibration(pairs, upright()));
}

}  // namespace
}  // namespace byre
