#include "byre/slam/loops/loop_closing.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/loops/finishing.h"
#include "byre/slam/places/place_scene.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

// A lap and a fifth whose second half has points of its own and is displaced by a drift, as without any recognised
// loop.
class LoopInAMap : public testing::Test {
 protected:
  static constexpr int kFrames = 72;

  static SimulatedMission mission(const SimulationOptions& options = {}) {
    return simulate_mission(simulated_rig(), circling_trajectory(kFrames, 10.0, 2.0, 1.2), options);
  }

  explicit LoopInAMap(const SimulatedMission& mission = LoopInAMap::mission())
      : mission_(mission), index_(vocabulary_of(mission_)) {
    options_.min_gap = 15;
    const MapGraph truth = true_map(mission_, 3, Origin::online);
    for (const KeyframeId id : truth.keyframe_ids()) {
      Keyframe keyframe = *truth.find_keyframe(id);
      const bool is_new = id.number >= kFirstNew;
      if (is_new) keyframe.camera_from_world = keyframe.camera_from_world * inverse(new_from_old_);
      for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
      map_.add_rig(mission_.rig);
      index_.add(map_.add_keyframe(keyframe), index_.vocabulary().words_of(*keyframe.frame.features));
      map_.set_words(id, index_.vocabulary().words_of(*keyframe.frame.features));
    }
    for (const PointId id : truth.point_ids()) {
      add_point(truth, id, false);
      add_point(truth, id, true);
    }
  }

  // Adds a point with the observations of the older or of the newer keyframes.
  void add_point(const MapGraph& truth, PointId id, bool newer) {
    std::vector<Observation> seen;
    for (const Observation& observation : truth.observations(id)) {
      if ((observation.keyframe.number >= kFirstNew) == newer) seen.push_back(observation);
    }
    if (seen.empty()) return;
    MapPoint point = *truth.find_point(id);
    if (newer) point.position_in_world = new_from_old_ * point.position_in_world;
    point.reference = seen.front();
    const PointId added = map_.add_point(point);
    for (const Observation& observation : seen) {
      const Keypoint& keypoint =
          map_.find_keyframe(observation.keyframe)->frame.features->keypoint(observation.feature);
      map_.add_observation(observation, {added, keypoint.pixel, 1.0f});
    }
  }

  KeyframeId newest() const { return map_.keyframe_ids().back(); }

  // The loop after checks with frames at their poses in the newer half.
  LoopHypothesis checked(LoopHypothesis loop, const std::vector<std::size_t>& frames) const {
    for (const std::size_t frame : frames) {
      const Pose camera_from_world = true_camera_from_world(mission_, frame) * inverse(new_from_old_);
      loop = check_loop(loop, mission_.frames[frame], camera_from_world, mission_.rig, map_);
    }
    return loop;
  }

  static constexpr std::uint32_t kFirstNew = 12;  // number of the newer half's first keyframe, of 24
  const SimulatedMission mission_;
  const Pose new_from_old_{Eigen::Quaterniond::Identity(), {0.1, -0.05, 0.02}};
  MapGraph map_{Origin::online};
  PlaceIndex index_;
  LoopOptions options_;
};

TEST_F(LoopInAMap, IsFoundWithItsDrift) {
  ASSERT_THAT(find_faults(map_), testing::IsEmpty());
  const auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  EXPECT_LT(loop->place.number, kFirstNew);
  EXPECT_THAT(loop->old_from_new, PoseNear(inverse(new_from_old_), 0.03, 0.01));
  EXPECT_GT(apparent_drift(*loop, map_), 3.0);
}

TEST_F(LoopInAMap, IsNotSearchedAmongNeighbours) {
  options_.min_gap = 1;
  const auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  EXPECT_LT(loop->place.number, kFirstNew) << "nearer keyframes share points with the newest";
  options_.min_gap = 24;
  EXPECT_FALSE(find_loop(map_, index_, newest(), options_)) << "everything is near";
}

TEST_F(LoopInAMap, IsRejectedForAnImplausibleDrift) {
  options_.max_drift = 0.01;
  options_.max_drift_share = 0.001;
  EXPECT_FALSE(find_loop(map_, index_, newest(), options_));
}

TEST_F(LoopInAMap, IsConfirmedByLaterFrames) {
  const auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  EXPECT_FALSE(is_confirmed(*loop));
  EXPECT_FALSE(is_confirmed(checked(*loop, {66, 67})));
  EXPECT_TRUE(is_confirmed(checked(*loop, {66, 67, 68})));
  EXPECT_FALSE(is_refuted(checked(*loop, {66, 67, 68})));
}

TEST_F(LoopInAMap, IsConfirmedDespiteACoveredFrame) {
  auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  loop = check_loop(*loop, Frame{{}, std::make_shared<const Features>()}, map_.camera_from_world(newest()),
                    mission_.rig, map_);
  EXPECT_EQ(loop->untracked, 1);
  EXPECT_TRUE(is_confirmed(checked(*loop, {66, 67, 68})));
}

TEST_F(LoopInAMap, IsRefutedByContradictingFrames) {
  auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  const Pose displaced{Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.0}};
  for (const std::size_t frame : {66u, 67u, 68u}) {
    const Pose camera_from_world = displaced * true_camera_from_world(mission_, frame) * inverse(new_from_old_);
    loop = check_loop(*loop, mission_.frames[frame], camera_from_world, mission_.rig, map_);
  }
  EXPECT_TRUE(is_refuted(*loop));
}

TEST_F(LoopInAMap, IsNotFoundWithoutWords) {
  map_.set_words(newest(), {});
  EXPECT_FALSE(find_loop(map_, index_, newest(), options_));
}

TEST_F(LoopInAMap, IsFoundWhenTheRunEnds) {
  FinishOptions options;
  options.loops = options_;
  EXPECT_FALSE(search_loops(map_, index_, options, {}).empty());
}

// The newer half shows another bay whose gate looks like that of the older bay; all else differs.
class LookalikeGate : public LoopInAMap {
 protected:
  LookalikeGate() : LoopInAMap(mission_with_gate()) {}

  static SimulatedMission mission_with_gate() {
    SimulatedMission mission = LoopInAMap::mission({.landmarks = 5000});
    const auto is_elsewhere = [&](int landmark) {
      const Eigen::Vector3d& position = mission.landmarks_in_world[static_cast<std::size_t>(landmark)];
      return position.y() < 3.9 || std::abs(position.x() + 1.5) > 1.5;
    };
    for (std::size_t i = 3 * kFirstNew; i < mission.frames.size(); ++i) {
      std::vector<int>& landmarks = mission.landmark_of_feature[i];
      mission.frames[i] = seen_beside(
          mission.frames[i], mission.rig,
          [&, feature = std::size_t{0}](const auto& /*pixel*/) mutable { return is_elsewhere(landmarks[feature++]); });
      std::erase_if(landmarks, is_elsewhere);
    }
    return mission;
  }
};

TEST_F(LookalikeGate, IsRefutedThoughFramesAreTrackedThere) {
  const auto found = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(found);
  const LoopHypothesis loop = checked(*found, {66, 67, 68});
  EXPECT_TRUE(loop.test.is_confirmed());
  EXPECT_EQ(loop.untracked, 0);
  EXPECT_FALSE(is_confirmed(loop));
  EXPECT_TRUE(is_refuted(loop)) << "log-odds " << loop.test.log_odds();
}

TEST_F(LookalikeGate, IsNoLoopWhenTheRunEnds) {
  FinishOptions options;
  options.loops = options_;
  EXPECT_TRUE(search_loops(map_, index_, options, {}).empty());
}

}  // namespace
}  // namespace byre
