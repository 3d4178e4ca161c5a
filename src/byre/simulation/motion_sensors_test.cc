#include "byre/simulation/motion_sensors.h"

#include "byre/simulation/cowshed/feeding_robot.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kSeconds = 30.0;

Trajectory drive() {
  const FeedingCourse course({.duration_s = kSeconds});
  Trajectory truth;
  for (int i = 0; i < static_cast<int>(kSeconds * 200.0); ++i) {
    truth.push_back({from_seconds(0.005 * i), course.world_from_body(0.005 * i)});
  }
  return truth;
}

Pose motion_between(const Trajectory& path, double from, double to) {
  constexpr Timestamp kGap = std::chrono::seconds(1);
  return inverse(*pose_at(path, from_seconds(from), kGap)) * *pose_at(path, from_seconds(to), kGap);
}

// An error-free accelerometer, integrated twice, reproduces the trajectory.
TEST(MotionSensors, MeasureAccelerationsWithGravity) {
  const Trajectory truth = drive();
  const MotionSamples exact = simulate_motion(truth, {.acceleration_noise = 0.0, .acceleration_bias = 0.0});
  ASSERT_EQ(exact.accelerations.size(), exact.rates.size());
  const std::size_t begin = 400;
  Eigen::Vector3d place = truth[begin].world_from_body.translation;
  Eigen::Vector3d velocity = (place - truth[begin - 1].world_from_body.translation) / 0.005;
  for (std::size_t i = begin; i < begin + 2000; ++i) {
    const Eigen::Vector3d measured = truth[i].world_from_body.rotation * exact.accelerations[i].acceleration;
    velocity += 0.005 * (measured - Eigen::Vector3d(0.0, 0.0, 9.81));
    place += 0.005 * velocity;
  }
  EXPECT_LT((place - truth[begin + 2000].world_from_body.translation).norm(), 1e-6) << "metres, after ten seconds";
  const MotionSamples measured = simulate_motion(truth, {});
  Eigen::Vector3d error = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < measured.accelerations.size(); ++i) {
    error += (measured.accelerations[i].acceleration - exact.accelerations[i].acceleration) /
             static_cast<double>(measured.accelerations.size());
  }
  EXPECT_GT(error.norm(), 0.01) << "bias";
  EXPECT_LT(error.norm(), 0.2) << "bias";
}

TEST(MotionSensors, AreExactWithoutErrors) {
  const Trajectory truth = drive();
  const MotionSamples measured = simulate_motion(truth, {.radius_error = 0.0,
                                                         .radius_difference = 0.0,
                                                         .slip = 0.0,
                                                         .tick = 1e-6,
                                                         .wheel_delay = 0.0,
                                                         .rate_noise = 0.0,
                                                         .rate_bias = 0.0});
  const Pose wheels = motion_between(measured.wheels, 1.0, 28.0), path = motion_between(truth, 1.0, 28.0);
  EXPECT_LT((wheels.translation - path.translation).head<2>().norm(), 0.05);
  EXPECT_NEAR(rotation_log(wheels.rotation).z(), rotation_log(path.rotation).z(), 0.01);
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  for (const AngularRate& rate : measured.rates) turn = turn * rotation_exp(0.005 * rate.rate);
  const Pose whole = inverse(truth.front().world_from_body) * truth.back().world_from_body;
  EXPECT_LT(angle_between(turn, whole.rotation), 1e-6);
}

TEST(MotionSensors, HaveTheGivenErrors) {
  const Trajectory truth = drive();
  const MotionSamples measured = simulate_motion(truth, {.radius_error = 0.05, .slip = 0.0});
  const double way = motion_between(truth, 2.0, 12.0).translation.norm();
  EXPECT_NEAR(motion_between(measured.wheels, 2.03, 12.03).translation.norm(), way / 0.95, 0.01 * way);
  EXPECT_EQ(measured.wheels.front().time, truth.front().time + std::chrono::milliseconds(30));
}

TEST(MotionSensors, MeasureATurnWhileAWheelIsLifted) {
  const Trajectory truth = drive();
  const MotionSamples measured = simulate_motion(truth, {.lifted_from = 5.0, .lifted_to = 8.0});
  const double measured_turn = rotation_log(motion_between(measured.wheels, 5.03, 8.03).rotation).z();
  const double turn = rotation_log(motion_between(truth, 5.0, 8.0).rotation).z();
  EXPECT_GT(std::abs(measured_turn - turn), 0.3);
}

TEST(MotionSensors, AreDeterministicForASeed) {
  const Trajectory truth = drive();
  const MotionSamples once = simulate_motion(truth, {.seed = 4}), again = simulate_motion(truth, {.seed = 4});
  const MotionSamples other = simulate_motion(truth, {.seed = 5});
  EXPECT_EQ(once.rates.back().rate, again.rates.back().rate);
  EXPECT_EQ(once.wheels.back().world_from_body, again.wheels.back().world_from_body);
  EXPECT_NE(once.rates.back().rate, other.rates.back().rate);
}

}  // namespace
}  // namespace byre
