#include "byre/slam/loops/global_mapping.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/loops/drift_scene.h"
#include "byre/slam/tracking/mission_scene.h"
#include "byre/slam/window/online_copy.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kFramesPerKeyframe = 3;
constexpr std::uint32_t kFirstNew = 10;  // number of the newer half's first keyframe, of 20

SimulatedMission lap() {
  SimulationOptions options = without_noise();
  options.disparity_sigma = 0.02;  // zero would count as no disparity
  return simulate_mission(simulated_rig(), circling_trajectory(60, 10.0, 2.0, 1.0), options);
}

// Drift after this share of the lap.
Pose drifted_from_true(double share) {
  return {rotation_exp(share * Eigen::Vector3d(0.01, 0.02, 0.0)), share * Eigen::Vector3d(0.15, -0.1, 0.05)};
}

MapGraph drifted_map(const SimulatedMission& mission) {
  MapGraph map = true_map(mission, kFramesPerKeyframe, Origin::online);
  const auto share = [&](KeyframeId id) { return id.number / static_cast<double>(map.keyframe_count()); };
  for (const PointId id : map.point_ids()) {
    MapPoint point = *map.find_point(id);
    point.position_in_world = drifted_from_true(share(point.reference.keyframe)) * point.position_in_world;
    map.update_point(id, point);
  }
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    map.move_keyframe(id, keyframe.camera_from_world * inverse(drifted_from_true(share(id))), keyframe.covariance);
  }
  return map;
}

double worst_position_error(const MapGraph& map, const SimulatedMission& mission) {
  double worst = 0.0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    const Pose truth = true_camera_from_world(mission, frame_at(mission, keyframe.frame.time));
    const Pose difference = keyframe.camera_from_world * inverse(truth);
    worst = std::max(worst, difference.translation.norm());
  }
  return worst;
}

LoopEdge true_loop(const MapGraph& map, const SimulatedMission& mission) {
  const KeyframeId first = map.keyframe_ids().front(), last = map.keyframe_ids().back();
  const auto truth = [&](KeyframeId id) {
    return true_camera_from_world(mission, frame_at(mission, map.find_keyframe(id)->frame.time));
  };
  return {last, first, truth(last) * inverse(truth(first)), 1e-8 * Matrix6::Identity()};
}

TEST(WholeMap, ContainsEverythingAndMovesAllButTheFirst) {
  const SimulatedMission mission = lap();
  const MapGraph map = drifted_map(mission);
  const MapWindow whole = whole_map(map);
  ASSERT_EQ(static_cast<int>(whole.keyframes.size()), map.keyframe_count());
  EXPECT_EQ(static_cast<int>(whole.points.size()), map.point_count());
  for (const WindowKeyframe& keyframe : whole.keyframes) {
    EXPECT_EQ(keyframe.movable, keyframe.keyframe.parent.has_value());
  }
  for (const WindowPoint& point : whole.points) EXPECT_EQ(point.observations_elsewhere, 0);
}

TEST(AdjustMap, CorrectsADriftedMap) {
  const SimulatedMission mission = lap();
  MapGraph map = drifted_map(mission);
  const double before = worst_position_error(map, mission);
  const MapWindow whole = whole_map(map);
  apply_correction(adjust_map(MapWindow(whole), whole, {true_loop(map, mission)}, {}), whole, map);
  EXPECT_GT(before, 0.1);
  EXPECT_LT(worst_position_error(map, mission), 0.1 * before);
  EXPECT_THAT(find_faults(map), testing::IsEmpty());
}

// Monocular scale drift, constrained by wheels between successive keyframes.
TEST(AdjustMap, HoldsTheScaleToMeasuredMotions) {
  const auto error_with = [](bool is_told) {
    DriftedLap lap(monocular_rig(), {1.2, {}});
    MapWindow whole = whole_map(lap.map);
    const auto truth = [&](std::size_t keyframe) {
      const Timestamp time = whole.keyframes[keyframe].keyframe.frame.time;
      return lap.mission.truth[frame_at(lap.mission, time)].world_from_body;
    };
    Matrix6 covariance = 1e-4 * Matrix6::Identity();
    for (std::size_t i = 1; is_told && i < whole.keyframes.size(); ++i) {
      const int earlier = static_cast<int>(i) - 1, later = static_cast<int>(i);
      whole.motions.push_back({earlier, later, {inverse(truth(i - 1)) * truth(i), covariance}});
    }
    apply_correction(adjust_map(MapWindow(whole), whole, {}, {}), whole, lap.map);
    return worst_position_error(lap.map, lap.mission);
  };
  EXPECT_GT(error_with(false), 0.05);
  EXPECT_LT(error_with(true), 0.02);
}

TEST(AdjustMap, GivesTheSameResultAtOnce) {
  const SimulatedMission mission = lap();
  MapGraph in_two_steps = drifted_map(mission), at_once = in_two_steps;
  const MapWindow whole = whole_map(in_two_steps);
  const std::vector<LoopEdge> loops = {true_loop(at_once, mission)};
  apply_correction(adjust_map(MapWindow(whole), whole, loops, {}), whole, in_two_steps);
  EXPECT_THAT(adjust_at_once(whole, loops, {}, at_once), testing::IsEmpty());
  EXPECT_THAT(find_faults(at_once), testing::IsEmpty());
  ASSERT_EQ(at_once.point_ids(), in_two_steps.point_ids());
  for (const PointId id : at_once.point_ids()) {
    EXPECT_EQ(at_once.find_point(id)->position_in_world, in_two_steps.find_point(id)->position_in_world);
    EXPECT_EQ(at_once.observations(id), in_two_steps.observations(id));
  }
  for (const KeyframeId id : at_once.keyframe_ids()) {
    EXPECT_EQ(at_once.find_keyframe(id)->camera_from_world.translation,
              in_two_steps.find_keyframe(id)->camera_from_world.translation);
  }
}

TEST(AdjustMap, StopsOnRequest) {
  const SimulatedMission mission = lap();
  const MapGraph map = drifted_map(mission);
  const MapWindow whole = whole_map(map);
  const MapDelta delta = adjust_map(MapWindow(whole), whole, {}, {}, [] { return true; });
  EXPECT_THAT(delta.moved_keyframes, testing::IsEmpty());
}

TEST(AdjustMap, IsDeterministic) {
  const SimulatedMission mission = lap();
  const MapGraph map = drifted_map(mission);
  const MapWindow whole = whole_map(map);
  const MapDelta once = adjust_map(MapWindow(whole), whole, {true_loop(map, mission)}, {});
  const MapDelta again = adjust_map(MapWindow(whole), whole, {true_loop(map, mission)}, {});
  ASSERT_EQ(once.moved_keyframes.size(), again.moved_keyframes.size());
  for (std::size_t i = 0; i < once.moved_keyframes.size(); ++i) {
    EXPECT_EQ(once.moved_keyframes[i].camera_from_world.translation,
              again.moved_keyframes[i].camera_from_world.translation);
  }
}

// A correction that shifts the newer half of a map by a metre.
class ShiftedHalf : public testing::Test {
 protected:
  ShiftedHalf() {
    MapWindow after = before_;
    for (WindowKeyframe& keyframe : after.keyframes) {
      if (keyframe.id.number < kFirstNew) continue;
      keyframe.keyframe.camera_from_world = keyframe.keyframe.camera_from_world * inverse(kShift);
    }
    correction_ = difference(before_, after);
  }

  static inline const Pose kShift{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}};
  const SimulatedMission mission_ = lap();
  MapGraph map_ = true_map(mission_, kFramesPerKeyframe, Origin::online);
  const MapWindow before_ = whole_map(map_);
  MapDelta correction_;
};

TEST_F(ShiftedHalf, MovesLaterKeyframesAlong) {
  Keyframe later = *map_.find_keyframe({Origin::online, 15});
  for (Sighting& sighting : later.sightings) sighting.point.reset();
  later.parent = KeyframeId{Origin::online, 15};
  const KeyframeId id = map_.add_keyframe(later);
  apply_correction(correction_, before_, map_);
  EXPECT_THAT(map_.find_keyframe(id)->camera_from_world,
              PoseNear(later.camera_from_world * inverse(kShift), 1e-9, 1e-9));
  EXPECT_THAT(find_faults(map_), testing::IsEmpty());
}

TEST_F(ShiftedHalf, LeavesElementsOutsideOfTheCopy) {
  MapWindow part = window_of(map_, {{Origin::online, 10}, {Origin::online, 19}});
  MapWindow after = part;
  for (WindowKeyframe& keyframe : after.keyframes) {
    keyframe.keyframe.camera_from_world = keyframe.keyframe.camera_from_world * inverse(kShift);
  }
  const MapGraph before = map_;
  apply_correction(difference(part, after), part, map_);
  for (const std::uint32_t left_out : {9u, 11u, 18u}) {
    const KeyframeId id{Origin::online, left_out};
    EXPECT_EQ(map_.find_keyframe(id)->camera_from_world.translation,
              before.find_keyframe(id)->camera_from_world.translation);
  }
  EXPECT_NE(map_.find_keyframe({Origin::online, 10})->camera_from_world.translation,
            before.find_keyframe({Origin::online, 10})->camera_from_world.translation);
}

TEST_F(ShiftedHalf, KeepsTheMotionOfKeyframesMeanwhile) {
  const KeyframeId id{Origin::online, 12};
  const Pose moved = exp_pose(Vector6::Constant(0.01)) * map_.find_keyframe(id)->camera_from_world;
  map_.move_keyframe(id, moved, Matrix6::Zero());
  apply_correction(correction_, before_, map_);
  EXPECT_THAT(map_.find_keyframe(id)->camera_from_world, PoseNear(moved * inverse(kShift), 1e-9, 1e-9));
}

TEST_F(ShiftedHalf, MovesPointsWithTheirReferenceKeyframe) {
  PointId newer{}, older{};
  for (const PointId id : map_.point_ids()) {
    (map_.find_point(id)->reference.keyframe.number >= kFirstNew ? newer : older) = id;
  }
  const Eigen::Vector3d newer_before = map_.find_point(newer)->position_in_world;
  const Eigen::Vector3d older_before = map_.find_point(older)->position_in_world;
  apply_correction(correction_, before_, map_);
  EXPECT_THAT(map_.find_point(newer)->position_in_world, PointNear(newer_before + Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_THAT(map_.find_point(older)->position_in_world, PointNear(older_before, 1e-9));
}

TEST_F(ShiftedHalf, ToleratesRemovedElements) {
  map_.remove_keyframe({Origin::online, 14});
  map_.remove_point(map_.point_ids().front());
  apply_correction(correction_, before_, map_);
  EXPECT_THAT(find_faults(map_), testing::IsEmpty());
}

TEST(OnlineCopy, EqualsTheMapWithOnlineIds) {
  const SimulatedMission mission = lap();
  const MapGraph offline = true_map(mission, kFramesPerKeyframe, Origin::offline);
  const MapGraph online = online_copy(offline);
  EXPECT_EQ(online.origin(), Origin::online);
  EXPECT_EQ(online.keyframe_count(), offline.keyframe_count());
  EXPECT_EQ(online.point_count(), offline.point_count());
  EXPECT_THAT(find_faults(online), testing::IsEmpty());
}

TEST(AdjustedMaps, KeepTheFrameOfTheOfflineMapDespitePointsThatMovedFar) {
  MapWindow before;
  before.rigs = {simulated_rig()};
  before.keyframes.resize(2);
  before.keyframes[0].id = {Origin::online, 0};
  before.keyframes[1].id = {Origin::offline, 0};
  for (std::uint32_t i = 0; i < 200; ++i) {
    WindowPoint& point = before.points.emplace_back();
    point.id = {Origin::offline, i};
    point.point.position_in_world = {0.1 * (i % 10), 0.3 * (i / 10), 2.0 + 0.05 * (i % 7)};
    point.point.covariance = (i < 100 ? 1e-6 : 1e-4) * Eigen::Matrix3d::Identity();
  }
  const Pose moved{rotation_exp({0.01, 0.02, 0.0}), {0.02, 0.0, 0.01}};
  MapWindow adjusted = before;
  for (WindowKeyframe& entry : adjusted.keyframes) {
    entry.keyframe.camera_from_world = entry.keyframe.camera_from_world * inverse(moved);
  }
  for (WindowPoint& point : adjusted.points) point.point.position_in_world = moved * point.point.position_in_world;
  adjusted.points[3].point.position_in_world.z() += 500.0;
  const AdjustedOffline offline = detach_offline(adjusted, before);
  EXPECT_LT(offline.camera_from_world.at({Origin::offline, 0}).translation.norm(), 1e-6);
  EXPECT_LT(adjusted.keyframes[0].keyframe.camera_from_world.translation.norm(), 1e-6);
}

}  // namespace
}  // namespace byre
