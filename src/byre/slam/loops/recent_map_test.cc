#include "byre/slam/loops/recent_map.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/loops/finishing.h"
#include "byre/slam/places/place_scene.h"
#include "byre/slam/tracking/mission_scene.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr int kKeyframes = 60;
constexpr std::uint32_t kFirstThatCame = 52;  // the last eight are new

SimulatedMission long_way() {
  SimulationOptions options;
  options.pixel_sigma = 0.3;
  options.disparity_sigma = 0.1;
  return simulate_mission(simulated_rig(), circling_trajectory(kKeyframes, 10.0, 2.0, 0.9), options);
}

// Limits each point to a few successive keyframes, as behind corners.
void forget_distant_views(MapGraph& map) {
  constexpr std::uint32_t kViews = 6;
  for (const PointId id : map.point_ids()) {
    const std::vector<Observation> views = map.observations(id);
    for (const Observation& seen : views) {
      if (seen.keyframe.number >= views.front().keyframe.number + kViews) map.remove_observation(seen);
    }
  }
}

class RecentMap : public testing::Test {
 protected:
  // The new keyframes are slightly off, as after local mapping.
  RecentMap() {
    forget_distant_views(map_);
    for (const KeyframeId id : map_.keyframe_ids()) {
      if (id.number < kFirstThatCame) continue;
      const Keyframe& keyframe = *map_.find_keyframe(id);
      map_.move_keyframe(id, exp_pose(Vector6::Constant(0.02)) * keyframe.camera_from_world, keyframe.covariance);
    }
  }

  Pose true_pose(KeyframeId id) const {
    return true_camera_from_world(mission_, frame_at(mission_, map_.find_keyframe(id)->frame.time));
  }

  const SimulatedMission mission_ = long_way();
  MapGraph map_ = true_map(mission_, 1, Origin::online);
};

TEST_F(RecentMap, MovesNewKeyframesAndTheirNeighbours) {
  const MapWindow recent = recent_map(map_, kFirstThatCame, {});
  std::set<KeyframeId> movable, all;
  for (const WindowKeyframe& keyframe : recent.keyframes) {
    all.insert(keyframe.id);
    if (keyframe.movable) movable.insert(keyframe.id);
  }
  EXPECT_LT(2 * all.size(), static_cast<std::size_t>(map_.keyframe_count()));
  EXPECT_GT(movable.size(), static_cast<std::size_t>(kKeyframes) - kFirstThatCame);
  EXPECT_LT(movable.size(), all.size()) << "there are no anchors";
  for (std::uint32_t i = kFirstThatCame; i < kKeyframes; ++i) EXPECT_TRUE(movable.contains({Origin::online, i}));
}

TEST_F(RecentMap, ContainsAllObservationsOfMovingPoints) {
  const MapWindow recent = recent_map(map_, kFirstThatCame, {});
  for (const WindowPoint& point : recent.points) {
    EXPECT_EQ(point.observations_elsewhere, 0);
    const bool is_of_movable = std::ranges::any_of(point.observations, [&](const WindowObservation& seen) {
      return recent.keyframes[static_cast<std::size_t>(seen.keyframe)].movable;
    });
    EXPECT_TRUE(is_of_movable);
  }
}

TEST_F(RecentMap, StartsWithAnchorsAndEndsWithTheNewest) {
  const MapWindow recent = recent_map(map_, kFirstThatCame, {});
  EXPECT_FALSE(recent.keyframes.front().movable);
  EXPECT_EQ(recent.keyframes.back().id, map_.keyframe_ids().back());
  EXPECT_TRUE(std::ranges::is_partitioned(recent.keyframes, [](const auto& keyframe) { return !keyframe.movable; }));
}

TEST_F(RecentMap, IsTheWholeMapIfMostKeyframesAreNeighbours) {
  EXPECT_EQ(static_cast<int>(recent_map(map_, 0, {}).keyframes.size()), map_.keyframe_count());
  EXPECT_EQ(static_cast<int>(recent_map(map_, kKeyframes / 2, {}).keyframes.size()), map_.keyframe_count());
}

TEST_F(RecentMap, ContainsTheEndsOfLoops) {
  const KeyframeId place{Origin::online, 5};
  const MapWindow recent = recent_map(map_, kFirstThatCame, {{map_.keyframe_ids().back(), place, {}}});
  const auto found = std::ranges::find(recent.keyframes, place, &WindowKeyframe::id);
  ASSERT_NE(found, recent.keyframes.end());
}

TEST_F(RecentMap, LeavesDistantKeyframes) {
  const MapWindow recent = recent_map(map_, kFirstThatCame, {});
  std::set<KeyframeId> near;
  for (const WindowKeyframe& keyframe : recent.keyframes) near.insert(keyframe.id);
  const MapGraph before = map_;
  FinishOptions options;
  options.first_new = kFirstThatCame;
  finish_map(map_, PlaceIndex(vocabulary_of(mission_)), options, {});
  EXPECT_THAT(find_faults(map_), IsEmpty());
  int far_points = 0;
  for (const KeyframeId id : before.keyframe_ids()) {
    if (near.contains(id)) continue;
    EXPECT_EQ(map_.find_keyframe(id)->camera_from_world.translation,
              before.find_keyframe(id)->camera_from_world.translation);
    EXPECT_EQ(map_.find_keyframe(id)->camera_from_world.rotation.coeffs(),
              before.find_keyframe(id)->camera_from_world.rotation.coeffs());
    for (const Sighting& sighting : before.find_keyframe(id)->sightings) {
      if (!sighting.point || std::ranges::any_of(before.observations(*sighting.point),
                                                 [&](const auto& seen) { return near.contains(seen.keyframe); })) {
        continue;
      }
      ++far_points;
      ASSERT_NE(map_.find_point(*sighting.point), nullptr);
      EXPECT_EQ(map_.find_point(*sighting.point)->position_in_world,
                before.find_point(*sighting.point)->position_in_world);
      EXPECT_EQ(map_.find_point(*sighting.point)->covariance, before.find_point(*sighting.point)->covariance);
    }
  }
  EXPECT_GT(far_points, 1000);
}

TEST_F(RecentMap, IsCorrectedLikeTheWholeMap) {
  const auto worst_error = [&](const MapGraph& map) {
    double worst = 0.0;
    for (const KeyframeId id : map.keyframe_ids()) {
      const Pose difference = map.find_keyframe(id)->camera_from_world * inverse(true_pose(id));
      worst = std::max(worst, difference.translation.norm());
    }
    return worst;
  };
  const PlaceIndex nothing(vocabulary_of(mission_));
  MapGraph by_all = map_, by_recent = map_;
  finish_map(by_all, nothing, {}, {});
  FinishOptions options;
  options.first_new = kFirstThatCame;
  finish_map(by_recent, nothing, options, {});
  EXPECT_LT(worst_error(by_recent), 0.6 * worst_error(map_));
  EXPECT_LT(worst_error(by_recent), 1.1 * worst_error(by_all));
}

TEST(Disagreement, MeasuresTheErrorOfALoop) {
  const MapGraph map = true_map(long_way(), 1, Origin::online);
  const KeyframeId one{Origin::online, 3}, other{Origin::online, 30};
  LoopEdge loop{other, one, map.camera_from_world(other) * inverse(map.camera_from_world(one))};
  EXPECT_NEAR(disagreement(map, loop), 0.0, 1e-12);
  loop.keyframe_from_place.translation.x() += 0.1;
  EXPECT_NEAR(disagreement(map, loop), 0.1, 1e-12);
  loop.place = {Origin::online, 99};
  EXPECT_EQ(disagreement(map, loop), 0.0);
}

}  // namespace
}  // namespace byre
