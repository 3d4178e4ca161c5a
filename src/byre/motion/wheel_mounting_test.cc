#include "byre/motion/wheel_mounting.h"

#include "byre/motion/drive_scene.h"

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

void expect_near(const WheelMounting& mounting, const Drive& drive, double metres, double radians, double share) {
  EXPECT_LT((mounting.base_from_body.translation - drive.base_from_body.translation).norm(), metres);
  EXPECT_LT(angle_between(mounting.base_from_body.rotation, drive.base_from_body.rotation), radians);
  EXPECT_NEAR(mounting.metres_per_unit, drive.metres_per_unit, share * drive.metres_per_unit);
}

TEST(WheelMounting, IsFoundToTheLastDigitWithoutNoise) {
  for (const double metres_per_unit : {1.0, 0.37, 12.0}) {
    const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = metres_per_unit};
    const auto mounting = find_wheel_mounting(pairs_of(drive, 30.0));
    ASSERT_TRUE(mounting);
    expect_near(*mounting, drive, 1e-5, 1e-6, 1e-6);
  }
}

TEST(WheelMounting, IsFoundThroughNoiseAndSlip) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37, .noise = 0.002};
  std::vector<MotionPair> pairs = pairs_of(drive, 60.0);
  for (std::size_t i = 0; i < pairs.size(); i += 5) pairs[i].base.translation *= 3.0;
  const auto mounting = find_wheel_mounting(pairs);
  ASSERT_TRUE(mounting);
  expect_near(*mounting, drive, 0.01, 0.02, 0.01);
  EXPECT_LT(mounting->scale_sigma, 0.01);
}

TEST(WheelMounting, TellsTheMotionOfTheBody) {
  const Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = 0.37};
  const auto mounting = find_wheel_mounting(pairs_of(drive, 30.0));
  ASSERT_TRUE(mounting);
  std::mt19937 random(3);
  const Pose seen = inverse(drive.seen(40.0, random)) * drive.seen(43.0, random);
  const Pose told = body_motion(*mounting, inverse(Drive::world_from_base(40.0)) * Drive::world_from_base(43.0));
  EXPECT_LT((told.translation - seen.translation).norm(), 1e-4);
  EXPECT_LT(angle_between(told.rotation, seen.rotation), 1e-5);
}

TEST(WheelMounting, StaysOpenWithoutTurning) {
  MotionPair ahead;
  ahead.base.translation.x() = ahead.body.translation.z() = 0.25;
  const std::vector<MotionPair> pairs(60, ahead);
  EXPECT_FALSE(find_wheel_mounting(pairs));
}

TEST(WheelMounting, StaysOpenWithoutDriving) {
  const Drive drive{.base_from_body = camera_on_base()};
  std::vector<MotionPair> pairs = pairs_of(drive, 30.0);
  for (MotionPair& pair : pairs) pair.base.translation.setZero();
  EXPECT_FALSE(find_wheel_mounting(pairs));
}

TEST(WheelMounting, IsPresumedByASecondOfWay) {
  for (const double metres_per_unit : {1.0, 0.37, 12.0}) {
    Drive drive{.base_from_body = camera_on_base(), .metres_per_unit = metres_per_unit, .noise = 0.001};
    drive.base_from_body.rotation = drive.base_from_body.rotation * rotation_exp({0.3, 0.0, 0.0});  // looks down
    const std::vector<MotionPair> pairs = pairs_of(drive, 1.5);
    EXPECT_FALSE(find_wheel_mounting(pairs));
    const auto mounting = presume_wheel_mounting(pairs, -Eigen::Vector3d::UnitY());
    ASSERT_TRUE(mounting);
    EXPECT_LT(angle_between(mounting->base_from_body.rotation, drive.base_from_body.rotation), 0.15);
    EXPECT_NEAR(mounting->metres_per_unit, metres_per_unit, 0.05 * metres_per_unit);
    EXPECT_GE(mounting->way_error, 0.1);
  }
}

// Turns tell the axis in the end, whatever was presumed of it.
TEST(WheelMounting, IsPresumedAsItTurnsThoughItIsNotUpright) {
  Drive drive{.base_from_body = camera_on_base(), .noise = 0.001};
  drive.base_from_body.rotation = drive.base_from_body.rotation * rotation_exp({0.0, 0.0, 1.5});  // lies on its side
  const auto mounting = presume_wheel_mounting(pairs_of(drive, 8.0), -Eigen::Vector3d::UnitY());
  ASSERT_TRUE(mounting);
  EXPECT_LT(angle_between(mounting->base_from_body.rotation, drive.base_from_body.rotation), 0.1);
}

TEST(WheelMounting, IsPresumedToLookAheadBeforeAnythingIsSeen) {
  const Drive drive{.base_from_body = camera_on_base()};
  const auto mounting = presume_looking_ahead(-Eigen::Vector3d::UnitY(), Eigen::Vector3d::UnitZ());
  ASSERT_TRUE(mounting);
  EXPECT_LT(angle_between(mounting->base_from_body.rotation, drive.base_from_body.rotation), 0.15);
  EXPECT_EQ(mounting->way_error, 1.0) << "it may as well look aside";
  EXPECT_FALSE(presume_looking_ahead(-Eigen::Vector3d::UnitY(), Eigen::Vector3d(0.0, -1.0, 0.1)))
      << "a camera that looks up tells nothing of what is ahead";
}

TEST(WheelMounting, IsNotPresumedByTurningOnTheSpot) {
  const Drive drive{.base_from_body = camera_on_base()};
  std::vector<MotionPair> pairs = pairs_of(drive, 3.0);
  for (MotionPair& pair : pairs) pair.base.translation.setZero();
  EXPECT_FALSE(presume_wheel_mounting(pairs, -Eigen::Vector3d::UnitY()));
}

}  // namespace
}  // namespace byre
