#include "byre/viewer/scene.h"

#include "byre/geometry/geometry_matchers.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;
using ::testing::SizeIs;

Rig rig_ahead_of_the_body() {
  Rig rig{752, 480, 400.0, 376.0, 240.0, 0.1, {}};
  rig.body_from_camera.translation = Eigen::Vector3d(0.5, 0.0, 1.0);
  return rig;
}

// Map with one keyframe at the origin that observes one point.
MapGraph map_of_one_point(Origin origin, double depth) {
  MapGraph map(origin);
  Keyframe keyframe;
  keyframe.frame.time = from_seconds(3.0);
  keyframe.frame.features = std::make_shared<const Features>(752, 480, std::vector<Keypoint>(1),
                                                             std::vector<Descriptor>(1), std::vector<Patch>{});
  keyframe.rig = map.add_rig(rig_ahead_of_the_body());
  const KeyframeId seen_by = map.add_keyframe(keyframe);
  MapPoint point;
  point.position_in_world = Eigen::Vector3d(0.0, 0.0, depth);
  const PointId id = map.add_point(point);
  map.add_observation({seen_by, 0}, {id, Eigen::Vector2f(376.0f, 240.0f), 1.0f});
  return map;
}

TEST(Scene, ContainsOfflineThenOnlinePoints) {
  const MapGraph offline = map_of_one_point(Origin::offline, 2.0);
  const MapGraph online = map_of_one_point(Origin::online, 3.0);
  const MapScene scene = scene_of({&offline, online});
  ASSERT_THAT(scene.points, SizeIs(2));
  EXPECT_EQ(scene.points[0].origin, Origin::offline);
  EXPECT_EQ(scene.points[0].position_in_map, Eigen::Vector3f(0.0f, 0.0f, 2.0f));
  EXPECT_EQ(scene.points[1].origin, Origin::online);
  EXPECT_EQ(scene.points[1].position_in_map, Eigen::Vector3f(0.0f, 0.0f, 3.0f));
}

TEST(Scene, PlacesKeyframesAtTheBody) {
  const MapGraph online = map_of_one_point(Origin::online, 2.0);
  const MapScene scene = scene_of(online);
  ASSERT_THAT(scene.keyframes, SizeIs(1));
  EXPECT_EQ(scene.keyframes[0].time, from_seconds(3.0));
  EXPECT_THAT(scene.keyframes[0].map_from_body.translation, PointNear(Eigen::Vector3d(-0.5, 0.0, -1.0), 1e-12));
}

TEST(Scene, IsEmptyForAnEmptyMap) {
  const MapScene scene = scene_of(MapGraph(Origin::online));
  EXPECT_THAT(scene.points, IsEmpty());
  EXPECT_THAT(scene.keyframes, IsEmpty());
}

}  // namespace
}  // namespace byre
