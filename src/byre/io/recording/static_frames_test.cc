#include "byre/io/recording/static_frames.h"

#include "byre/geometry/geometry_matchers.h"

#include <limits>

#include <gtest/gtest.h>

namespace byre {
namespace {

Pose some_pose(double seed) {
  const Eigen::Vector3d turn(0.3 * seed, -0.2, 0.1 + seed);
  return {rotation_exp(turn), {seed, 2.0 - seed, 0.5 * seed}};
}

ros::TFMessage fixed(const std::string& parent, const std::string& child, const Pose& parent_from_child) {
  const Eigen::Vector3d& t = parent_from_child.translation;
  const Eigen::Quaterniond& q = parent_from_child.rotation;
  return {{{{.frame_id = parent}, child, {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}}}}};
}

TEST(StaticFrames, ComposeTransformsAlongTheTree) {
  StaticFrames frames;
  frames.take(fixed("base_link", "mast", some_pose(1)));
  frames.take(fixed("/mast", "camera", some_pose(2)));
  frames.take(fixed("base_link", "laser", some_pose(3)));
  EXPECT_THAT(*frames.between("base_link", "camera"), PoseNear(some_pose(1) * some_pose(2), 1e-9, 1e-9));
  EXPECT_THAT(*frames.between("laser", "camera"),
              PoseNear(inverse(some_pose(3)) * some_pose(1) * some_pose(2), 1e-9, 1e-9));
  EXPECT_THAT(*frames.between("mast", "mast"), PoseNear(Pose{}, 1e-12, 1e-12));
  EXPECT_FALSE(frames.between("base_link", "wheel"));
}

TEST(StaticFrames, IgnoreInvalidTransforms) {
  StaticFrames frames;
  frames.take(fixed("a", "b", some_pose(1)));
  frames.take(fixed("b", "a", some_pose(2)));  // circular
  ros::TFMessage broken = fixed("a", "c", {});
  broken.transforms[0].transform.rotation.w = 0.0;
  frames.take(broken);
  broken = fixed("a", "d", {});
  broken.transforms[0].transform.translation.x = std::numeric_limits<double>::quiet_NaN();
  frames.take(broken);
  EXPECT_FALSE(frames.between("x", "b"));
  EXPECT_FALSE(frames.between("a", "c"));
  EXPECT_FALSE(frames.between("a", "d"));
  EXPECT_TRUE(frames.between("a", "b"));
}

}  // namespace
}  // namespace byre
