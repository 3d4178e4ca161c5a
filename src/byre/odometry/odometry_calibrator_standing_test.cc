#include "byre/odometry/prior_scene.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

// A drive with gyroscope and accelerometer, which stops for good. Frames are tracked until `dark`.
struct Stop {
  double at = 40.0;        // seconds
  double dark = 30.0;      // seconds
  double drift = 0.0;      // change of the gyroscope's bias in the dark, radians per second
  bool shows_stop = true;  // shown by wheels; false: they continue a slow drive
};

OdometryCalibrator followed_to_a_stop(const Drive& drive, const Stop& stop, double end) {
  OdometryCalibrator prior;
  std::mt19937 random(5);
  // Brakes evenly over half a second. speed: share of the speed before.
  constexpr double kBraking = 0.5;  // seconds
  const auto braked = [&](double t) { return std::clamp(t - stop.at + 0.5 * kBraking, 0.0, kBraking); };
  const auto time_driven = [&](double t) {
    const double u = braked(t);
    return std::min(t, stop.at - 0.5 * kBraking) + u - u * u / (2.0 * kBraking);
  };
  const auto speed = [&](double t) { return 1.0 - braked(t) / kBraking; };
  const Pose map_from_first = inverse(drive.base_from_body);
  for (int step = 0; step * 0.01 < end; ++step) {
    const double t = step * 0.01, driven = time_driven(t);
    StampedPose wheels = drive.wheels(driven);
    wheels.time = from_seconds(t);
    if (t > stop.at && !stop.shows_stop) wheels.world_from_body.translation.x() += 0.05 * (t - stop.at);
    if (step % 2 == 0) prior.add(wheels);
    Eigen::Vector3d rate = speed(t) * (kBodyFromGyroscope.conjugate() * rate_of_body(drive, driven)) + kBias;
    if (t >= stop.dark) rate += Eigen::Vector3d::Constant(stop.drift);
    prior.add(AngularRate{from_seconds(t), rate});
    const Eigen::Vector3d up = drive.base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
    const double swing = t < stop.at ? 0.5 * std::sin(3.0 * t) : 0.0;
    prior.add(
        Acceleration{from_seconds(t), kBodyFromGyroscope.conjugate() * (9.81 * up) + Eigen::Vector3d(swing, 0, 0)});
    if (step % 5 != 0) continue;
    const bool is_seen = t < stop.dark;
    prior.note(from_seconds(t), is_seen ? std::optional(drive.seen(driven, random)) : std::nullopt);
    if (is_seen) prior.note_place(map_from_first * Drive::world_from_base(driven) * drive.base_from_body);
  }
  return prior;
}

TEST(OdometryCalibrator, EstimatesTheGyroscopeBiasAtStandstillInTheDark) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibrator prior = followed_to_a_stop(drive, {.drift = 0.004}, 50.0);
  ASSERT_TRUE(prior.gyroscope());
  EXPECT_LT((prior.gyroscope()->bias - kBias - Eigen::Vector3d::Constant(0.004)).norm(), 1e-3);
  const BodyMotion measured = over(prior, 47.0, 49.9);
  EXPECT_LT(rotation_log(measured.last_from_body.rotation).norm(), 1e-3);
  EXPECT_LT(std::sqrt(rotation_variance(measured.covariance)), 2e-3);
  EXPECT_LT(std::sqrt(position_variance(measured.covariance)), 0.01);
}

TEST(OdometryCalibrator, DetectsNoStandstillWhileWheelsCreep) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const OdometryCalibrator prior = followed_to_a_stop(drive, {.drift = 0.004, .shows_stop = false}, 50.0);
  EXPECT_EQ(prior.stationary().stops(), 0);
  EXPECT_FALSE(prior.tilt(from_seconds(49.9)));
}

TEST(OdometryCalibrator, MeasuresTheTiltInTheDarkAfterAVisibleStop) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  EXPECT_FALSE(followed_to_a_stop(drive, {}, 50.0).tilt(from_seconds(49.9)))
      << "the up direction of the map is unknown";
  const OdometryCalibrator prior = followed_to_a_stop(drive, {.dark = 44.0}, 50.0);
  ASSERT_TRUE(prior.calibration_to_store().up);
  const auto tilt = prior.tilt(from_seconds(49.9));
  ASSERT_TRUE(tilt);
  EXPECT_LT(tilt->sigma, 0.02);
  const Pose body = inverse(drive.base_from_body) * Drive::world_from_base(40.0) * drive.base_from_body;
  EXPECT_LT((body.rotation * tilt->up_in_body - tilt->up_in_map).norm(), 2.0 * tilt->sigma);
}

}  // namespace
}  // namespace byre
