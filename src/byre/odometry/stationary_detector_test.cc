#include "byre/odometry/stationary_detector.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kTrueGravity = 9.81;  // m/s^2
const Eigen::Quaterniond kWorldFromSensor = rotation_exp({0.4, -0.9, 0.3});
const Eigen::Vector3d kStillRate(0.02, -0.01, 0.03);         // radians per second
const Eigen::Vector3d kAccelerationBias(0.04, -0.05, 0.03);  // m/s^2
const StationaryDetector::StationaryEvidence kWheelsStand{true, {}};

// Motion of a sensor at 200 Hz between two times in seconds, in the world's axes.
struct SensorMotion {
  double from = 0.0;
  double until = 2.0;
  Eigen::Vector3d acceleration = Eigen::Vector3d::Zero();  // m/s^2, in addition to gravity
  double sway = 0.0;                                       // m/s^2, oscillation at 1 Hz
  double vibration = 0.0;                                  // m/s^2, motor vibration at 37 Hz
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();          // radians per second, of the sensor
};

template <typename Target>
void feed(Target& target, const SensorMotion& measured) {
  constexpr double kPi = 3.14159265358979;
  std::mt19937 random(3);
  std::normal_distribution<double> noise;
  const auto noise3 = [&] { return Eigen::Vector3d(noise(random), noise(random), noise(random)); };
  for (double t = measured.from; t <= measured.until + 1e-9; t += 0.005) {
    Eigen::Vector3d in_world = measured.acceleration + Eigen::Vector3d(0.0, 0.0, kTrueGravity);
    in_world.x() += measured.sway * std::sin(2.0 * kPi * t);
    in_world.z() += measured.vibration * std::sin(2.0 * kPi * 37.0 * t);
    target.add(AngularRate{from_seconds(t), measured.rate + kStillRate + 0.004 * noise3()});
    target.add(
        Acceleration{from_seconds(t), kWorldFromSensor.conjugate() * in_world + kAccelerationBias + 0.03 * noise3()});
  }
}

std::optional<SteadyWindow::Steady> told_until_end(const SensorMotion& measured) {
  SteadyWindow track;
  feed(track, measured);
  return track.until(from_seconds(measured.until));
}

double error_of(const SteadyWindow::Steady& steady) {
  return (steady.up - kWorldFromSensor.conjugate() * Eigen::Vector3d::UnitZ()).norm();
}

TEST(SteadyWindow, MeasuresTheUpDirectionAtRest) {
  for (const double vibration : {0.0, 1.0}) {
    const auto steady = told_until_end({.vibration = vibration});
    ASSERT_TRUE(steady) << vibration;
    EXPECT_LT(error_of(*steady), 2.0 * steady->sigma);
    EXPECT_LT(steady->sigma, 0.01);
    EXPECT_LT((steady->rate - kStillRate).norm(), 0.001);
  }
}

TEST(SteadyWindow, IsEmptyWhileTheBodySwaysOrTurns) {
  EXPECT_FALSE(told_until_end({.sway = 0.3}));
  EXPECT_FALSE(told_until_end({.vibration = 5.0}));
  EXPECT_FALSE(told_until_end({.rate = {0.0, 0.3, 0.0}}));
  EXPECT_FALSE(told_until_end({.acceleration = {2.0, 0.0, 8.0}})) << "much larger than gravity";
}

TEST(SteadyWindow, IsEmptyForTooFewSamples) {
  EXPECT_FALSE(told_until_end({.until = 0.5}));
  SteadyWindow rates;
  for (int i = 0; i < 400; ++i) rates.add(AngularRate{from_seconds(0.005 * i), kStillRate});
  EXPECT_FALSE(rates.until(from_seconds(1.9)));
  EXPECT_FALSE(rates.has_accelerations());
}

TEST(SteadyWindow, IsEmptyUntilAStopFillsItsWindow) {
  SteadyWindow track;
  feed(track, {.until = 1.0, .acceleration = {-0.4, 0.0, 0.0}});
  feed(track, {.from = 1.005, .until = 3.0});
  EXPECT_FALSE(track.until(from_seconds(1.4)));
  EXPECT_TRUE(track.until(from_seconds(1.9)));
}

// Even braking is as steady as a stop: 0.3 m/s^2 equals a tilt of 1.7 degrees.
TEST(StationaryDetector, IsNotDetectedDuringSlowBraking) {
  const SensorMotion braking{.acceleration = {-0.3, 0.0, 0.0}};
  const auto steady = told_until_end(braking);
  ASSERT_TRUE(steady);
  EXPECT_GT(error_of(*steady), 0.02);
  StationaryDetector detector;
  feed(detector, braking);
  const auto at = [&](const StationaryDetector::StationaryEvidence& evidence) {
    return detector.at(from_seconds(braking.until), evidence, kStillRate);
  };
  EXPECT_FALSE(at({})) << "no evidence of standstill";
  EXPECT_FALSE(at({false, {}}));
  EXPECT_FALSE(at({false, true}));
  EXPECT_FALSE(at({true, false})) << "locked wheels may slide";
  EXPECT_TRUE(at({true, {}}));
}

TEST(StationaryDetector, IsNotDetectedDuringASlowTurn) {
  StationaryDetector detector;
  feed(detector, {.rate = {0.0, 0.0, 0.06}});
  EXPECT_TRUE(detector.at(from_seconds(2.0), kWheelsStand, {})) << "it may be bias";
  EXPECT_FALSE(detector.at(from_seconds(2.0), kWheelsStand, kStillRate));
}

TEST(StationaryDetector, CountsStops) {
  StationaryDetector detector;
  const SteadyWindow::Steady steady;
  for (int i = 0; i < 100; ++i) {
    const bool stands = (i >= 20 && i < 40) || i >= 70;
    detector.note(from_seconds(0.1 * i), stands ? std::optional(steady) : std::nullopt);
  }
  EXPECT_EQ(detector.stops(), 2);
  EXPECT_NEAR(detector.seconds(), 4.8 + 2 * 0.8, 0.21);
}

// A calibration found by turns about the up axis of the body only.
GyroscopeCalibration known_about_one_axis(double turn) {
  GyroscopeCalibration calibration;
  calibration.body_from_gyroscope = rotation_exp({0.0, 0.0, turn}) * kWorldFromSensor;
  calibration.covariance = Eigen::Vector3d(1e-5, 1e-5, GyroscopeCalibration::kOpenTurn).asDiagonal();
  return calibration;
}

SteadyWindow::Steady up_at(const Eigen::Quaterniond& world_from_sensor) {
  return {world_from_sensor.conjugate() * Eigen::Vector3d::UnitZ(), 0.005, kStillRate};
}

TEST(UpInBody, IsEstimatedForALevelBodyDespiteTurnsAboutOneAxis) {
  for (const double turn : {0.0, 2.0}) {  // rotation that the turns leave unconstrained
    const GyroscopeCalibration calibration = known_about_one_axis(turn);
    const UpInBody level = up_in_body(up_at(kWorldFromSensor), calibration);
    EXPECT_LT((level.up - Eigen::Vector3d::UnitZ()).norm(), 1e-6);
    EXPECT_LT(level.sigma, 0.007);
    const Eigen::Vector3d slope(0.05, 0.0, 0.0);
    const UpInBody sloping = up_in_body(up_at(rotation_exp(slope) * kWorldFromSensor), calibration);
    const Eigen::Vector3d truth = rotation_exp(-slope) * Eigen::Vector3d::UnitZ();
    EXPECT_LT((sloping.up - truth).norm(), 2.0 * sloping.sigma) << "the direction of the slope is unknown";
    EXPECT_GT(sloping.sigma, 0.05);
  }
}

TEST(StationaryDetector, MeasuresTheTiltByStopsAtKnownPoses) {
  GyroscopeCalibration calibration;
  calibration.covariance = 1e-5 * Eigen::Matrix3d::Identity();
  const Eigen::Quaterniond map_from_world = rotation_exp({0.7, 0.2, -0.5});
  StationaryDetector detector;
  EXPECT_FALSE(detector.tilt(from_seconds(99.0), up_at(kWorldFromSensor), calibration))
      << "the up direction of the map is unknown";
  for (int stop = 0; stop < 8; ++stop) {  // different headings, slightly tilted, sensor with a bias
    const Eigen::Quaterniond world_from_sensor =
        rotation_exp({0.0, 0.0, 0.8 * stop}) * rotation_exp({0.02, 0.01 * stop, 0.0}) * kWorldFromSensor;
    SteadyWindow::Steady steady = up_at(world_from_sensor);
    steady.up = (steady.up + Eigen::Vector3d(0.004, -0.003, 0.002)).normalized();
    detector.note(from_seconds(10.0 * stop), steady);
    detector.note_place(map_from_world * world_from_sensor);
    detector.note(from_seconds(10.0 * stop + 5.0), std::nullopt);
  }
  const auto up = detector.up_in_map(calibration);
  ASSERT_TRUE(up);
  EXPECT_LT((up->up_in_map - map_from_world * Eigen::Vector3d::UnitZ()).norm(), up->sigma);
  EXPECT_LT(up->sigma, 0.01);
  const auto tilt =
      detector.tilt(from_seconds(99.0), up_at(rotation_exp({0.0, 0.1, 1.0}) * kWorldFromSensor), calibration);
  ASSERT_TRUE(tilt);
  EXPECT_LT(tilt->sigma, 0.015);
  const Eigen::Quaterniond map_from_body = map_from_world * rotation_exp({0.0, 0.1, 1.0}) * kWorldFromSensor;
  EXPECT_LT((map_from_body * tilt->up_in_body - tilt->up_in_map).norm(), 2.0 * tilt->sigma);
  EXPECT_FALSE(detector.tilt(from_seconds(99.0), std::nullopt, calibration));
  EXPECT_FALSE(detector.tilt(from_seconds(99.0), up_at(kWorldFromSensor), GyroscopeCalibration{}))
      << "the mounting is unknown";
}

}  // namespace
}  // namespace byre
