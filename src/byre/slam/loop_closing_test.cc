#include "byre/slam/loop_closing.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// A lap and a bit, mapped with its second half in a place of its own: as if nothing had been recognised, and displaced
// by a drift.
class LoopInAMap : public testing::Test {
 protected:
  static constexpr int kFrames = 72;

  static SimulatedMission mission() {
    return simulate_mission(simulated_rig(), circling_trajectory(kFrames, 10.0, 2.0, 1.2), {});
  }

  explicit LoopInAMap(const Pose& new_from_old = {Eigen::Quaterniond::Identity(), {0.1, -0.05, 0.02}})
      : mission_(mission()), new_from_old_(new_from_old), index_(vocabulary_of(mission_)) {
    options_.min_gap = 15;
    const Map truth = true_map(mission_, 3, Origin::online);
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

  // What the older or the newer keyframes see of a point, as a point of their own.
  void add_point(const Map& truth, PointId id, bool newer) {
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

  static constexpr std::uint32_t kFirstNew = 12;  // number of the newer half's first keyframe, of 24
  const SimulatedMission mission_;
  const Pose new_from_old_;
  Map map_{Origin::online};
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

TEST_F(LoopInAMap, IsNotLookedForAmongNeighbours) {
  options_.min_gap = 1;
  const auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  EXPECT_LT(loop->place.number, kFirstNew) << "nearer keyframes share points with the newest";
  options_.min_gap = 24;
  EXPECT_FALSE(find_loop(map_, index_, newest(), options_)) << "everything is near";
}

TEST_F(LoopInAMap, IsNotBelievedWhenThePathAllowsNoSuchDrift) {
  options_.max_drift = 0.01;
  options_.max_drift_share = 0.001;
  EXPECT_FALSE(find_loop(map_, index_, newest(), options_));
}

TEST_F(LoopInAMap, IsConfirmedByFramesThatFindItToo) {
  auto loop = find_loop(map_, index_, newest(), options_);
  ASSERT_TRUE(loop);
  for (const std::size_t frame : {66u, 67u, 68u}) {
    EXPECT_FALSE(is_confirmed(*loop));
    const Pose camera_from_world = true_camera_from_world(mission_, frame) * inverse(new_from_old_);
    loop = check_loop(*loop, mission_.frames[frame], camera_from_world, mission_.rig, map_);
  }
  EXPECT_TRUE(is_confirmed(*loop));
  EXPECT_FALSE(is_refuted(*loop));
}

TEST_F(LoopInAMap, IsRefutedByFramesThatSayOtherwise) {
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

}  // namespace
}  // namespace byre
