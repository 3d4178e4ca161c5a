// Loops from detection to the corrected map, with and without scale drift.

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/loops/drift_scene.h"
#include "byre/slam/loops/finishing.h"
#include "byre/slam/loops/recent_map.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

FinishOptions finish_options() {
  FinishOptions options;
  options.loops.min_gap = 15;
  return options;
}

Pose drift_of_pose() {
  return {rotation_exp({0.02, 0.03, 0.01}), {0.1, -0.08, 0.04}};
}

// Distance between a loop's keyframe in the map and as measured by the loop, metres.
double gap_at(const LoopEdge& loop, const MapGraph& map) {
  const Pose keyframe_from_place = map.camera_from_world(loop.keyframe) * inverse(map.camera_from_world(loop.place));
  return (keyframe_from_place * inverse(loop.keyframe_from_place)).translation.norm();
}

class DriftingScale : public testing::TestWithParam<double> {
 protected:
  DriftedLap lap_{monocular_rig(), {GetParam(), drift_of_pose()}};
};

TEST_P(DriftingScale, IsMeasuredAtTheLoop) {
  ASSERT_THAT(find_faults(lap_.map), IsEmpty());
  const auto loop = find_loop(lap_.map, lap_.index, lap_.newest(), finish_options().loops);
  ASSERT_TRUE(loop);
  EXPECT_NEAR(loop->scale * lap_.drift_at(lap_.newest()).scale, 1.0, 0.025)
      << "points have the drift of their first observation";
  EXPECT_LT(loop->scale_sigma, 0.005);
}

TEST_P(DriftingScale, IsCorrectedByTheLoop) {
  MapGraph map = lap_.map;
  const FinishReport report = finish_map(map, lap_.index, finish_options(), {});
  EXPECT_GE(report.loops, 1);
  EXPECT_GT(lap_.worst_error(lap_.map, Scale::free), 0.1);
  EXPECT_LT(lap_.worst_error(map, Scale::free), 0.01);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

TEST_P(DriftingScale, IsCorrectedBeforePointsAreFused) {
  const auto loop = find_loop(lap_.map, lap_.index, lap_.newest(), finish_options().loops);
  ASSERT_TRUE(loop);
  const LoopEdge edge = *edge_of(*loop, lap_.map);
  MapGraph map = lap_.map;
  const MapWindow whole = whole_map(map);
  const auto without_bundle_adjustment = [] { return true; };
  const LengthChanges changes =
      apply_correction(adjust_map(MapWindow(whole), whole, {edge}, {}, without_bundle_adjustment), whole, map);
  EXPECT_GT(gap_at(edge, lap_.map), 0.2);
  EXPECT_LT(gap_at(in_new_lengths(edge, changes), map), 0.01);
}

TEST_P(DriftingScale, IsTheFactorOfLengths) {
  MapGraph map = lap_.map;
  const FinishReport report = finish_map(map, lap_.index, finish_options(), {});
  EXPECT_NEAR(report.length_changes.at(lap_.newest()) * lap_.drift_at(lap_.newest()).scale, 1.0, 0.035);
  EXPECT_FALSE(report.length_changes.contains({Origin::online, 0}));
}

INSTANTIATE_TEST_SUITE_P(LoopCorrection, DriftingScale, testing::Values(0.9, 1.1));

class LapWithScaleDrift : public testing::Test {
 protected:
  std::optional<LoopHypothesis> find() const { return find_loop(lap_.map, lap_.index, lap_.newest(), options_); }

  const DriftedLap lap_{monocular_rig(), {1.1, drift_of_pose()}};
  LoopOptions options_ = finish_options().loops;
};

TEST_F(LapWithScaleDrift, IsConfirmedByLaterFrames) {
  auto loop = find();
  ASSERT_TRUE(loop);
  const Similarity drift = lap_.drift_at(lap_.newest());
  for (const std::size_t frame : {66u, 68u, 71u}) {
    const Pose camera_from_world = move_camera(drift, true_camera_from_world(lap_.mission, frame));
    loop = check_loop(*loop, lap_.mission.frames[frame], camera_from_world, lap_.mission.rig, lap_.map);
  }
  EXPECT_TRUE(is_confirmed(*loop));
}

TEST_F(LapWithScaleDrift, IsRejectedBeyondTheAllowedScaleDrift) {
  options_.max_scale_drift = 0.05;
  EXPECT_FALSE(find());
}

TEST_F(LapWithScaleDrift, IsRejectedIfTooFewPointsMeasureTheScale) {
  options_.min_scale_points = 10000;
  EXPECT_FALSE(find());
}

TEST_F(LapWithScaleDrift, IsRejectedForAnUncertainScale) {
  options_.max_scale_sigma = 1e-5;
  EXPECT_FALSE(find());
}

TEST_F(LapWithScaleDrift, HasAnEdgeInTheUnitsOfBothSides) {
  const auto loop = find();
  ASSERT_TRUE(loop);
  const auto edge = edge_of(*loop, lap_.map);
  ASSERT_TRUE(edge);
  const Similarity drift = lap_.drift_at(loop->keyframe);
  const Pose true_keyframe_from_place = lap_.true_pose(loop->keyframe) * inverse(lap_.true_pose(loop->place));
  EXPECT_NEAR(edge->scale, drift.scale, 0.02);
  EXPECT_THAT(edge->keyframe_from_place, PoseNear(scale_lengths(true_keyframe_from_place, drift.scale), 0.02, 0.01));
}

TEST_F(LapWithScaleDrift, IncludesTheScaleInItsDrift) {
  auto loop = find();
  ASSERT_TRUE(loop);
  loop->old_from_new = Pose{};
  loop->scale = 1.02;
  EXPECT_GT(apparent_drift(*loop, lap_.map), 0.02 * lap_.mission.rig.focal);
}

TEST(LoopWithStereo, HasNoScale) {
  const DriftedLap lap(simulated_rig(), {1.0, drift_of_pose()});
  const auto loop = find_loop(lap.map, lap.index, lap.newest(), finish_options().loops);
  ASSERT_TRUE(loop);
  EXPECT_EQ(loop->scale, 1.0);
  EXPECT_EQ(edge_of(*loop, lap.map)->scale, 1.0);
}

TEST(LoopWithStereo, KeepsLengths) {
  const DriftedLap lap(simulated_rig(), {1.0, drift_of_pose()});
  MapGraph map = lap.map;
  const FinishReport report = finish_map(map, lap.index, finish_options(), {});
  EXPECT_GE(report.loops, 1);
  EXPECT_THAT(report.length_changes, IsEmpty());
  EXPECT_LT(lap.worst_error(map, Scale::fixed), 0.015);
}

// A loop of new keyframes shows the drift of earlier ones.
TEST(LoopWithStereo, BendsTheEarlierPathToo) {
  const DriftedLap lap(simulated_rig(), {1.0, drift_of_pose()});
  MapGraph map = lap.map;
  FinishOptions options = finish_options();
  options.first_new = lap.newest().number - 1;
  const FinishReport report = finish_map(map, lap.index, options, {});
  EXPECT_GE(report.loops, 1);
  EXPECT_LT(lap.worst_error(map, Scale::fixed), 0.015);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

// A lap so long that the surroundings of a loop's ends are a small part of the map.
class LongLap : public testing::Test {
 protected:
  FinishOptions options_of_what_came() const {
    FinishOptions options = finish_options();
    options.first_new = lap_.newest().number - 1;
    return options;
  }

  const DriftedLap lap_{simulated_rig(), {1.0, drift_of_pose()}, {.frames = 200, .step = 1, .max_views = 4}};
  const FinishOptions options_ = options_of_what_came();
  const LoopEdge edge_ = *edge_of(*find_loop(lap_.map, lap_.index, lap_.newest(), options_.loops), lap_.map);
  const MapWindow recent_ = recent_map(lap_.map, options_.first_new, {edge_});
};

TEST_F(LongLap, DisagreesAfterALocalAdjustment) {
  ASSERT_LT(2 * recent_.keyframes.size(), static_cast<std::size_t>(lap_.map.keyframe_count()));
  MapGraph map = lap_.map;
  adjust_at_once(recent_, {edge_}, options_.global, map);
  EXPECT_GT(disagreement(map, edge_), kMaxLoopDisagreement);
}

TEST_F(LongLap, IsAdjustedAsAWholeIfItDisagrees) {
  MapGraph map = lap_.map;
  const FinishReport report = finish_map(map, lap_.index, options_, {});
  ASSERT_GE(report.loops, 1);
  for (const double residual : report.loop_residuals) EXPECT_LT(residual, kMaxLoopDisagreement);
  EXPECT_THAT(find_faults(map), IsEmpty());
  std::set<KeyframeId> around;
  for (const WindowKeyframe& keyframe : recent_.keyframes) around.insert(keyframe.id);
  int moved = 0;
  for (const KeyframeId id : map.keyframe_ids()) {
    if (around.contains(id)) continue;
    const Pose change = map.camera_from_world(id) * inverse(lap_.map.camera_from_world(id));
    moved += change.translation.norm() > 1e-6 ? 1 : 0;
  }
  EXPECT_GT(moved, lap_.map.keyframe_count() / 3) << "far from the loop";
}

// A correction by which the newer half of a monocular map grows.
class HalfWithScaleDrift : public testing::Test {
 protected:
  HalfWithScaleDrift() {
    MapWindow after = before_;
    for (WindowKeyframe& keyframe : after.keyframes) {
      if (keyframe.id.number < kFirstNew) continue;
      keyframe.keyframe.camera_from_world = move_camera(kGrowth, keyframe.keyframe.camera_from_world);
    }
    for (WindowPoint& point : after.points) {
      if (point.point.reference.keyframe.number < kFirstNew) continue;
      point.point.position_in_world = kGrowth * point.point.position_in_world;
    }
    correction_ = difference(before_, after);
  }

  static constexpr std::uint32_t kFirstNew = 8;  // number of the first keyframe that the correction moves, of 24
  static inline const Similarity kGrowth{1.2, {rotation_exp({0.0, 0.0, 0.1}), {1.0, 0.0, 0.0}}};
  static constexpr KeyframeId kNew{Origin::online, 20};
  MapGraph map_ = DriftedLap(monocular_rig(), {}).map;
  const MapWindow before_ = whole_map(map_);
  MapDelta correction_;
};

TEST_F(HalfWithScaleDrift, MovesLaterKeyframesAlong) {
  Keyframe later = *map_.find_keyframe(kNew);
  for (Sighting& sighting : later.sightings) sighting.point.reset();
  later.parent = kNew;
  const KeyframeId id = map_.add_keyframe(later);
  const LengthChanges changes = apply_correction(correction_, before_, map_);
  EXPECT_THAT(map_.find_keyframe(id)->camera_from_world,
              PoseNear(move_camera(kGrowth, later.camera_from_world), 1e-6, 1e-6));
  EXPECT_NEAR(changes.at(id), 1.2, 1e-6);
}

TEST_F(HalfWithScaleDrift, MovesLaterPointsAlong) {
  MapPoint later = *map_.find_point(*std::ranges::find_if(map_.find_keyframe(kNew)->sightings, [](const Sighting& s) {
                                       return s.point.has_value();
                                     })->point);
  const auto free = std::ranges::find_if(map_.find_keyframe(kNew)->sightings,
                                         [](const Sighting& sighting) { return !sighting.point; });
  const int feature = static_cast<int>(free - map_.find_keyframe(kNew)->sightings.begin());
  later.reference = {kNew, feature};
  const PointId id = map_.add_point(later);
  map_.add_observation(later.reference, {id, free->pixel, 1.0f});
  apply_correction(correction_, before_, map_);
  EXPECT_THAT(map_.find_point(id)->position_in_world, PointNear(kGrowth * later.position_in_world, 1e-5));
  EXPECT_NEAR(map_.find_point(id)->max_distance, 1.2f * later.max_distance, 1e-3f);
}

TEST_F(HalfWithScaleDrift, MovesLaterKeyframesAlongIfWheelsHoldTheScale) {
  MapWindow held = before_;
  held.motions.push_back({0, 1, {Pose{}, Matrix6::Identity()}, true});
  ASSERT_FALSE(scale_may_drift(held));
  EXPECT_NEAR(apply_correction(correction_, held, map_).at(kNew), 1.2, 1e-6);
}

TEST_F(HalfWithScaleDrift, LeavesTheOlderHalf) {
  const LengthChanges changes = apply_correction(correction_, before_, map_);
  EXPECT_FALSE(changes.contains({Origin::online, kFirstNew - 1}));
  EXPECT_TRUE(changes.contains({Origin::online, kFirstNew + 1}));
}

TEST_F(HalfWithScaleDrift, MovesRemovedKeyframes) {
  const KeyframeId parent = *map_.find_keyframe(kNew)->parent;
  map_.remove_keyframe(kNew);
  const Pose then = map_.camera_from_world(kNew) * inverse(map_.camera_from_world(parent));
  const LengthChanges changes = apply_correction(correction_, before_, map_);
  const Pose now = map_.camera_from_world(kNew) * inverse(map_.camera_from_world(parent));
  EXPECT_THAT(now, PoseNear(scale_lengths(then, 1.2), 1e-6, 1e-6));
  EXPECT_NEAR(changes.at(kNew), 1.2, 1e-6);
}

TEST_F(HalfWithScaleDrift, ConvertsLoopsToTheNewLengths) {
  const LoopEdge old{
      kNew, {Origin::online, 0}, {Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}}, Matrix6::Identity(), 0.8};
  const LoopEdge now = in_new_lengths(old, apply_correction(correction_, before_, map_));
  EXPECT_THAT(now.keyframe_from_place.translation, PointNear(Eigen::Vector3d(0.6, 0.0, 0.0), 1e-6));
  EXPECT_NEAR(now.scale, 0.96, 1e-6);
  EXPECT_NEAR(now.covariance(0, 0), 1.44, 1e-5);
}

}  // namespace
}  // namespace byre
