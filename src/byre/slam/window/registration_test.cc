#include "byre/slam/window/registration.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/mission_scene.h"
#include "byre/slam/window/hybrid_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Contains;

const Pose kOfflineFromOnline{rotation_exp({0.0, 0.0, 0.02}), {0.3, -0.1, 0.05}};

class CorrectionOf : public ::testing::Test {
 protected:
  Pose world_motion_of(KeyframeId id, const MapGraph& after) const {
    return inverse(after.find_keyframe(id)->camera_from_world) * map_.find_keyframe(id)->camera_from_world;
  }

  const SimulatedMission mission_ = quarter_circle(without_noise());
  const MapGraph map_ = true_map(mission_, 4, Origin::online);
};

TEST_F(CorrectionOf, MovesAnUnregisteredMapRigidly) {
  MapGraph after = map_;
  apply(correction_of(map_, map_.keyframe_ids(), kOfflineFromOnline, CorrectionShape::rigid), after);
  for (const KeyframeId id : map_.keyframe_ids()) {
    EXPECT_THAT(world_motion_of(id, after), PoseNear(kOfflineFromOnline, 1e-9, 1e-9));
  }
  for (const PointId id : map_.point_ids()) {
    EXPECT_THAT(after.find_point(id)->position_in_world,
                PointNear(kOfflineFromOnline * map_.find_point(id)->position_in_world, 1e-9));
  }
  EXPECT_THAT(find_faults(after), testing::IsEmpty());
}

TEST_F(CorrectionOf, DistributesTheCorrectionAlongThePath) {
  MapGraph after = map_;
  apply(correction_of(map_, map_.keyframe_ids(), kOfflineFromOnline, CorrectionShape::spread), after);
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  EXPECT_THAT(world_motion_of(ids.front(), after), PoseNear(Pose{}, 1e-9, 1e-9));
  const auto moved = [&](KeyframeId id) {
    return (inverse(after.find_keyframe(id)->camera_from_world).translation -
            inverse(map_.find_keyframe(id)->camera_from_world).translation)
        .norm();
  };
  for (std::size_t i = 1; i < ids.size(); ++i) EXPECT_GT(moved(ids[i]), moved(ids[i - 1]));
  EXPECT_THAT(world_motion_of(ids.back(), after), PoseNear(kOfflineFromOnline, 1e-9, 1e-9));
}

TEST_F(CorrectionOf, LeavesElementsOutsideOfThePath) {
  const std::vector<KeyframeId> ids = map_.keyframe_ids();
  const std::vector<KeyframeId> path(ids.begin() + 4, ids.end() - 1);
  const MapDelta delta = correction_of(map_, path, kOfflineFromOnline, CorrectionShape::rigid);
  EXPECT_EQ(delta.moved_keyframes.size(), path.size());
  for (const MovedKeyframe& moved : delta.moved_keyframes) EXPECT_THAT(path, Contains(KeyframeId(moved.id)));
  for (const UpdatedPoint& updated : delta.updated_points) {
    EXPECT_THAT(path, Contains(map_.find_point(updated.id)->reference.keyframe));
  }
}

TEST_F(CorrectionOf, IsEmptyForAPathWithoutKeyframes) {
  const MapDelta delta = correction_of(map_, {}, kOfflineFromOnline, CorrectionShape::rigid);
  EXPECT_TRUE(delta.moved_keyframes.empty());
  EXPECT_TRUE(delta.updated_points.empty());
}

int sightings_of_offline_points(const MapGraph& online) {
  int count = 0;
  for (const KeyframeId id : online.keyframe_ids()) {
    for (const Sighting& sighting : online.find_keyframe(id)->sightings) {
      count += sighting.point && sighting.point->origin == Origin::offline;
    }
  }
  return count;
}

TEST(CorrectionOfAHybridMap, RemovesObservationsAtARefutedPlace) {
  HybridScene scene = two_true_maps({});
  see_offline(scene);
  const KeyframeId offline = scene.offline.keyframe_ids().front();
  const PointId point = scene.online.point_ids().front();
  ASSERT_TRUE(scene.online.add_foreign_view({{offline, 0}, {point, {10.0f, 10.0f}, 1.0f}}));
  const std::vector<KeyframeId> path = scene.online.keyframe_ids();
  MapGraph spread = scene.online, rigid = scene.online;
  apply(correction_of(scene.online, path, kOfflineFromOnline, CorrectionShape::spread), spread);
  apply(correction_of(scene.online, path, kOfflineFromOnline, CorrectionShape::rigid), rigid);
  EXPECT_GT(sightings_of_offline_points(spread), 100);
  EXPECT_FALSE(spread.foreign_views(point).empty());
  EXPECT_EQ(sightings_of_offline_points(rigid), 0);
  EXPECT_TRUE(rigid.foreign_views(point).empty());
  EXPECT_EQ(rigid.keyframe_count(), scene.online.keyframe_count());
  EXPECT_THAT(find_faults(rigid), testing::IsEmpty());
}

}  // namespace
}  // namespace byre
