#include "byre/slam/tracking/deferred_refinement.h"

#include "byre/slam/tracking/mission_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// An online map and the first frame of its mission, with its sightings of the map.
class HindsightTest : public testing::Test {
 protected:
  const SimulatedMission mission_ = quarter_circle(without_noise());
  MapGraph map_ = true_map(mission_, 2, Origin::online);
  const Pose true_pose_ = true_camera_from_world(mission_, 0);

  const Features& features() const { return *mission_.frames[0].features; }
  std::vector<PointId> seen_points() const {
    std::vector<PointId> points;
    for (const Sighting& sighting : map_.find_keyframe(map_.keyframe_ids().front())->sightings) {
      if (sighting.point) points.push_back(*sighting.point);
    }
    return points;
  }
  TrackedFrame tracked() const {
    TrackedFrame result;
    const Keyframe& keyframe = *map_.find_keyframe(map_.keyframe_ids().front());
    for (int i = 0; i < std::ssize(keyframe.sightings); ++i) {
      const Sighting& sighting = keyframe.sightings[static_cast<std::size_t>(i)];
      if (sighting.point) result.features.push_back({i, *sighting.point, sighting.pixel, sighting.pixel_sigma});
    }
    return result;
  }
  DeferredFrame remembered(const DeferredRefinementOptions& options) const {
    DeferredRefinement deferred_refinement(options);
    deferred_refinement.note(0, mission_.rig, features(), tracked());
    return deferred_refinement.take_oldest().value();
  }
  std::optional<Pose> pose_of(const DeferredFrame& frame) const {
    Vector6 off;
    off << 0.02, -0.01, 0.015, 0.002, 0.001, -0.002;  // error of tracking on imprecise points
    return refine_deferred_pose(frame, exp_pose(off) * true_pose_, MapView(nullptr, map_), {});
  }
};

TEST_F(HindsightTest, EstimatesThePoseInTheSettledMap) {
  const auto pose = pose_of(remembered({}));
  ASSERT_TRUE(pose);
  EXPECT_LT((inverse(*pose).translation - inverse(true_pose_).translation).norm(), 1e-3);
}

TEST_F(HindsightTest, IgnoresRemovedPoints) {
  const DeferredFrame frame = remembered({});
  const std::vector<PointId> points = seen_points();
  for (std::size_t i = 0; i < points.size(); i += 2) map_.remove_point(points[i]);
  const auto pose = pose_of(frame);
  ASSERT_TRUE(pose);
  EXPECT_LT((inverse(*pose).translation - inverse(true_pose_).translation).norm(), 1e-3);
}

TEST_F(HindsightTest, IsEmptyForFewOrInconsistentPoints) {
  const DeferredFrame frame = remembered({});
  DeferredFrame contradicting = frame;
  for (std::size_t i = 0; i < contradicting.points.size(); i += 2) contradicting.points[i].measured.x() += 30.0f;
  EXPECT_FALSE(pose_of(contradicting));
  for (const PointId point : seen_points()) map_.remove_point(point);
  EXPECT_FALSE(pose_of(frame));
}

// The frame was measured with the former rig; the pose is that of the present rig.
TEST_F(HindsightTest, UsesTheRigOfTheFrame) {
  Vector6 turn;
  turn << 0.0, 0.0, 0.0, 0.01, -0.02, 0.005;
  DeferredRefinement deferred_refinement({});
  deferred_refinement.note(0, mission_.rig, features(), tracked());
  deferred_refinement.rotate_rig(exp_pose(turn));
  deferred_refinement.rotate_rig(exp_pose(turn));
  const Pose expected = exp_pose(turn) * exp_pose(turn) * true_pose_;
  const auto pose =
      refine_deferred_pose(deferred_refinement.take_oldest().value(), expected, MapView(nullptr, map_), {});
  ASSERT_TRUE(pose);
  EXPECT_LT(log_pose(*pose * inverse(expected)).norm(), 1e-3);
}

TEST_F(HindsightTest, KeepsAtMostTheGivenNumberOfFrames) {
  DeferredRefinementOptions options;
  options.frames = 2;
  DeferredRefinement deferred_refinement(options);
  for (const std::size_t number : {3u, 4u}) deferred_refinement.note(number, mission_.rig, features(), tracked());
  EXPECT_FALSE(deferred_refinement.take_overdue());
  deferred_refinement.note(5, mission_.rig, features(), tracked());
  EXPECT_EQ(deferred_refinement.take_overdue().value().number, 3u);
  deferred_refinement.forget_from(5);
  EXPECT_EQ(deferred_refinement.take_oldest().value().number, 4u);
  EXPECT_FALSE(deferred_refinement.take_oldest());
}

TEST_F(HindsightTest, ReturnsEveryFrameWithItsPoints) {
  DeferredRefinement deferred_refinement({});
  const TrackedFrame all = tracked();
  constexpr std::size_t kFrames = 400;  // several blocks
  for (std::size_t number = 0; number < kFrames; ++number) {
    TrackedFrame some = all;
    some.features.resize(all.features.size() - number % 7);
    deferred_refinement.note(number, mission_.rig, features(), some);
  }
  for (std::size_t number = 0; number < kFrames; ++number) {
    const DeferredFrame frame = deferred_refinement.take_oldest().value();
    EXPECT_EQ(frame.number, number);
    ASSERT_EQ(frame.points.size(), all.features.size() - number % 7);
    for (std::size_t i = 0; i < frame.points.size(); ++i) EXPECT_EQ(frame.points[i].point, all.features[i].point);
  }
  EXPECT_FALSE(deferred_refinement.first());
}

TEST_F(HindsightTest, DetectsFramesHeldByOfflinePoints) {
  DeferredFrame frame = remembered({});
  EXPECT_FALSE(is_held_by_offline(frame));
  for (DeferredPoint& seen : frame.points) seen.point.origin = Origin::offline;
  EXPECT_TRUE(is_held_by_offline(frame));
}

TEST_F(HindsightTest, UsesAdjustedOfflinePoints) {
  const Eigen::Vector3d shift(0.0, 0.3, 0.0);
  AdjustedOffline offline;
  for (const PointId id : seen_points()) {
    offline.points_in_world[id] = map_.find_point(id)->position_in_world + shift;
  }
  const Pose moved = true_pose_ * Pose{Eigen::Quaterniond::Identity(), -shift};
  const auto pose = refine_deferred_pose(remembered({}), moved, MapView(nullptr, map_), {}, offline);
  ASSERT_TRUE(pose);
  EXPECT_LT((inverse(*pose).translation - inverse(moved).translation).norm(), 1e-3);
}

}  // namespace
}  // namespace byre
