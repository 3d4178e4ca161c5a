#include "byre/map/keyframe_path.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(KeyframePath, ReturnsBodyPositionsInOrderOfTime) {
  const Pose body_from_camera{rotation_exp({0.1, 0.2, 0.3}), {0.4, 0.5, 0.6}};
  const Pose world_from_camera{rotation_exp({0.0, 0.0, 1.0}), {1.0, 2.0, 3.0}};
  MapGraph map(Origin::offline);
  Rig rig;
  rig.body_from_camera = body_from_camera;
  map.add_rig(rig);
  for (const double second : {2.0, 1.0, 2.0}) {  // times of two recordings
    Keyframe keyframe;
    keyframe.frame.time = from_seconds(second);
    keyframe.camera_from_world = inverse(world_from_camera);
    map.add_keyframe(keyframe);
  }
  const Trajectory path = keyframe_path(map);
  ASSERT_EQ(path.size(), 2u);
  EXPECT_EQ(path[0].time, from_seconds(1.0));
  EXPECT_EQ(path[1].time, from_seconds(2.0));
  const Pose expected = world_from_camera * inverse(body_from_camera);
  EXPECT_NEAR(log_pose(inverse(path[0].world_from_body) * expected).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace byre
