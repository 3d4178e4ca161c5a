#include "byre/odometry/odometry_calibration.h"

#include "byre/alignment.h"
#include "byre/geometry/degrees.h"
#include "byre/odometry/drive_scene.h"

#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

std::vector<MotionPair> motions_of(const Drive& drive, double from, double to) {
  std::mt19937 random(3);
  std::vector<MotionPair> motions;
  for (double t = from; t < to; t += 0.5) {
    motions.push_back({inverse(Drive::world_from_base(t)) * Drive::world_from_base(t + 0.5),
                       inverse(drive.seen(t, random)) * drive.seen(t + 0.5, random)});
  }
  return motions;
}

OdometryCalibration known_from_a_drive(const Drive& drive) {
  OdometryCalibration known;
  known.wheels = estimate_wheel_calibration(motions_of(drive, 0.0, 60.0));
  known.gyroscope = GyroscopeCalibration{rotation_exp({0.3, 1.2, -0.4}), {0.01, 0.02, 0.03}, 0.004};
  known.gyroscope->covariance = Eigen::Vector3d(1e-5, 2e-5, 3.0).asDiagonal();
  known.up = UpInMap{Eigen::Vector3d(0.0, 0.6, 0.8), 0.006};
  known.time_offset = 0.031;
  return known;
}

double lever_error(const WheelCalibration& found, const Drive& drive) {
  return (found.base_from_body.translation - drive.base_from_body.translation).head<2>().norm();
}

TEST(OdometryCalibration, ReadsBackItsNotes) {
  const OdometryCalibration known = known_from_a_drive({.base_from_body = camera_on_base(), .noise = 0.001});
  ASSERT_TRUE(known.wheels);
  std::map<std::string, std::string> notes = {{"site", "barn 3"}};
  write_odometry_calibration(known, notes);
  const OdometryCalibration read = read_odometry_calibration(notes);
  ASSERT_TRUE(read.wheels && read.gyroscope);
  EXPECT_EQ(notes.at("site"), "barn 3");
  EXPECT_LT(angle_between(read.wheels->base_from_body.rotation, known.wheels->base_from_body.rotation), 1e-9);
  EXPECT_EQ(read.wheels->base_from_body.translation, known.wheels->base_from_body.translation);
  EXPECT_EQ(read.wheels->covariance, known.wheels->covariance);
  EXPECT_EQ(read.wheels->turn_errors.per_metre, known.wheels->turn_errors.per_metre);
  EXPECT_EQ(read.time_offset, 0.031);
  EXPECT_EQ(read.gyroscope->error, 0.004);
  EXPECT_EQ(read.gyroscope->covariance, known.gyroscope->covariance);
  ASSERT_TRUE(read.up);
  EXPECT_EQ(read.up->up_in_map, known.up->up_in_map);
  EXPECT_EQ(read.up->sigma, 0.006);
  EXPECT_EQ(read.gyroscope->bias, Eigen::Vector3d::Zero()) << "the bias changes between missions";
}

TEST(OdometryCalibration, IgnoresInvalidNotes) {
  EXPECT_TRUE(read_odometry_calibration({}).is_empty());
  EXPECT_TRUE(read_odometry_calibration({{"wheels", "four, of rubber"}, {"gyroscope", "none"}}).is_empty());
  std::map<std::string, std::string> notes;
  write_odometry_calibration(known_from_a_drive({.base_from_body = camera_on_base(), .noise = 0.001}), notes);
  notes["wheels"].resize(notes["wheels"].size() / 2);
  notes["gyroscope"] = "body_from_gyroscope_wxyz 1 0 0 0; error_rad_per_s 0.004";
  notes["gravity"] = "up_in_map 0 0 2; sigma_rad 0.01";
  EXPECT_FALSE(read_odometry_calibration(notes).up);
  ASSERT_TRUE(read_odometry_calibration(notes).gyroscope) << "notes of older versions";
  EXPECT_GT(read_odometry_calibration(notes).gyroscope->covariance.trace(), 9.0);
  EXPECT_FALSE(read_odometry_calibration(notes).wheels);
}

TEST(OdometryCalibration, ScalesWithTheUnitOfTheMap) {
  const OdometryCalibration known = known_from_a_drive({.base_from_body = camera_on_base(), .noise = 0.001});
  const OdometryCalibration longer = scaled(known, 2.0);
  EXPECT_NEAR(longer.wheels->metres_per_unit, 0.5 * known.wheels->metres_per_unit, 1e-12);
  EXPECT_EQ(longer.wheels->covariance, known.wheels->covariance) << "of the logarithm of the scale";
}

TEST(OdometryCalibration, IsKeptWithUninformativeMotions) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.98, .noise = 0.001};
  const OdometryCalibration known = known_from_a_drive(drive);
  const auto motions = motions_of(drive, 100.0, 101.5);
  const auto found = estimate_wheel_calibration(motions, as_prior(*known.wheels));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->metres_per_unit, 0.98, 0.004);
  EXPECT_LT(lever_error(*found, drive), 0.01);
}

TEST(OdometryCalibration, IsUpdatedByALongDrive) {
  Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 1.0, .noise = 0.001};
  const OdometryCalibration known = known_from_a_drive(drive);
  drive.metres_per_unit = 1.01;  // higher tyre pressure
  const auto found = estimate_wheel_calibration(motions_of(drive, 60.0, 160.0), as_prior(*known.wheels));
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->metres_per_unit, 1.01, 0.004);
}

TEST(OdometryCalibration, IsContradictedByAnotherMountingOnly) {
  const Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  const WheelCalibration known = as_prior(*known_from_a_drive(drive).wheels);
  const auto found_on = [](const Drive& other) {
    return estimate_wheel_calibration(motions_of(other, 60.0, 100.0)).value();
  };
  EXPECT_FALSE(is_contradicted(known, found_on(drive)));
  Drive pumped_up = drive;
  pumped_up.metres_per_unit = 1.01;
  EXPECT_FALSE(is_contradicted(known, found_on(pumped_up)));
  Drive moved = drive;
  moved.base_from_body.translation.x() += 0.15;
  EXPECT_TRUE(is_contradicted(known, found_on(moved)));
  Drive turned = drive;
  turned.base_from_body.rotation = rotation_exp({0.0, 0.0, 6.0 * kDegree}) * drive.base_from_body.rotation;
  EXPECT_TRUE(is_contradicted(known, found_on(turned)));
  Drive tilted = drive;
  tilted.base_from_body.rotation = rotation_exp({0.0, 6.0 * kDegree, 0.0}) * drive.base_from_body.rotation;
  EXPECT_TRUE(is_contradicted(known, found_on(tilted)));
}

// Notes of older versions have the covariance of four parameters.
TEST(OdometryCalibration, ReadsNotesOfOlderVersions) {
  const std::map<std::string, std::string> notes = {
      {"wheels",
       "base_from_body_wxyz 0.5 -0.5 0.5 -0.5; arm_m 0.4 0.1; metres_per_unit 2; scale_sigma 0.004; way_error 0.01; "
       "turn_error 0.02; turn_scale 1.01; turn_per_metre 0.001; covariance 1e-04 0 0 0 0 6.4e-05 0 0 0 0 9e-06 0 0 0 0 "
       "4e-06; delay_s 0.03"}};
  const auto read = read_odometry_calibration(notes).wheels;
  ASSERT_TRUE(read);
  EXPECT_EQ(read->base_from_body.translation, Eigen::Vector3d(0.4, 0.1, 0.0));
  EXPECT_NEAR(read->scale_sigma(), std::hypot(0.004, 0.007), 1e-6);
  EXPECT_NEAR(read->heading_sigma(), std::hypot(0.005, 0.007), 1e-6);
  EXPECT_NEAR(read->covariance(3, 3), 9e-6 + 1e-4, 1e-9);
}

TEST(OdometryCalibration, FollowsAChangeOfTheBodyFrame) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.5, .noise = 0.001};
  const OdometryCalibration before = known_from_a_drive(drive);
  const Pose before_from_after{rotation_exp({0.0, 0.3, 0.0}), {0.2, 0.0, 0.4}};  // in the map's lengths
  const OdometryCalibration after = moved(before, before_from_after);
  const Pose base{rotation_exp({0.0, 0.0, 0.7}), {0.5, 0.1, 0.0}};
  const Pose motion_before = body_motion(*before.wheels, base), motion_after = body_motion(*after.wheels, base);
  const Pose expected = inverse(before_from_after) * motion_before * before_from_after;
  EXPECT_LT((motion_after.translation - expected.translation).norm(), 0.01);
  EXPECT_LT(angle_between(motion_after.rotation, expected.rotation), 1e-9);
  const Pose arm = before.wheels->base_from_body * scale_lengths(before_from_after, before.wheels->metres_per_unit);
  EXPECT_LT((after.wheels->base_from_body.translation - arm.translation).norm(), 1e-12);
  const Eigen::Vector3d rate(0.1, 0.2, 0.3);  // about the gyroscope's axes
  const Eigen::Vector3d in_before = before.gyroscope->body_from_gyroscope * rate;
  EXPECT_TRUE((before_from_after.rotation * (after.gyroscope->body_from_gyroscope * rate)).isApprox(in_before, 1e-9));
}

}  // namespace
}  // namespace byre
