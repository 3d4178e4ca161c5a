#include "byre/features/rolling_shutter.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kReadoutTime = 0.03;  // seconds
const Eigen::Vector3d kPoint(0.8, 1.1, 3.0);

Rig rig_of_camera() {
  return {
      .width = 752, .height = 480, .focal = 430.0, .cx = 375.5, .cy = 239.5, .baseline = 0.11, .body_from_camera = {}};
}

CameraMotion motion() {
  CameraMotion motion;
  motion.velocity << 0.4, -0.2, 0.7, 0.3, -0.9, 0.2;
  motion.depth = kPoint.z();
  return motion;
}

// The point seen at the time of its row.
Keypoint rolled(bool has_disparity) {
  const Rig rig = rig_of_camera();
  Keypoint keypoint;
  keypoint.row_time = 0.35f;
  const StereoPixel pixel = rig.project(exp_pose(motion().velocity * (kReadoutTime * keypoint.row_time)) * kPoint);
  keypoint.pixel = pixel.head<2>().cast<float>();
  if (has_disparity) keypoint.disparity = static_cast<float>(pixel.z());
  return keypoint;
}

Keypoint at_once(const Keypoint& keypoint, const CameraMotion& motion, double readout_time) {
  const Rig rig = rig_of_camera();
  const Features features(rig.width, rig.height, {keypoint}, {Descriptor{}}, {});
  return correct_rolling_shutter(features, rig, motion, readout_time).keypoint(0);
}

TEST(SeenAtOnce, MovesACornerToTheTimeOfTheMiddleRow) {
  const StereoPixel expected = rig_of_camera().project(kPoint);
  const Keypoint seen = rolled(true), moved = at_once(seen, motion(), kReadoutTime);
  EXPECT_GT((seen.pixel - expected.head<2>().cast<float>()).norm(), 3.0f);
  EXPECT_NEAR(moved.pixel.x(), expected.x(), 0.02);
  EXPECT_NEAR(moved.pixel.y(), expected.y(), 0.02);
  EXPECT_NEAR(moved.disparity, expected.z(), 0.02);
  EXPECT_EQ(moved.row_time, seen.row_time);
}

TEST(SeenAtOnce, UsesTheSceneDepthForACornerWithoutDepth) {
  const StereoPixel expected = rig_of_camera().project(kPoint);
  const Keypoint moved = at_once(rolled(false), motion(), kReadoutTime);
  EXPECT_NEAR(moved.pixel.x(), expected.x(), 0.2);
  EXPECT_NEAR(moved.pixel.y(), expected.y(), 0.2);
  EXPECT_FALSE(moved.has_disparity());
}

TEST(SeenAtOnce, LeavesCornersAtRestAndWithAGlobalShutter) {
  const Keypoint seen = rolled(true);
  EXPECT_LT((at_once(seen, {}, kReadoutTime).pixel - seen.pixel).norm(), 1e-3f);
  EXPECT_LT((at_once(seen, motion(), 0.0).pixel - seen.pixel).norm(), 1e-3f);
}

TEST(SeenAtOnce, KeepsCornersInsideTheImage) {
  Keypoint corner = rolled(true);
  corner.pixel = {0.0f, 0.0f};
  CameraMotion fast = motion();
  fast.velocity *= 20.0;
  const Keypoint moved = at_once(corner, fast, kReadoutTime);
  EXPECT_TRUE(rig_of_camera().contains(moved.pixel.cast<double>()));
}

}  // namespace
}  // namespace byre
