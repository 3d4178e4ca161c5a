#include "byre/slam/mapping/anchored_trajectory.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/mission_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::SizeIs;

const Pose kAhead = exp_pose((Vector6() << 0.1, 0.0, -0.5, 0.0, 0.1, 0.0).finished());  // camera_from_keyframe

// A map of two keyframes, and a trajectory of one frame near each.
class AnchoredFrames : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = simulate_mission(simulated_rig(), circling_trajectory(9, 10.0, 2.0, 0.1), {});
  MapGraph map_ = true_map(mission_, 8, Origin::online);
  const std::vector<KeyframeId> keyframes_ = map_.keyframe_ids();
  AnchoredTrajectory trajectory_{DeferredRefinementOptions{}};
  Submaps submaps_;

  void SetUp() override {
    submaps_.begin_in_map_frame(0);
    for (const KeyframeId id : keyframes_) trajectory_.add({time_of(id), id, kAhead, 0});
  }
  Timestamp time_of(KeyframeId id) const { return map_.find_keyframe(id)->frame.time; }
};

TEST_F(AnchoredFrames, MoveWithTheirKeyframes) {
  const Pose moved = exp_pose((Vector6() << 1.0, 2.0, 3.0, 0.1, 0.2, 0.3).finished());
  map_.move_keyframe(keyframes_[1], moved, Matrix6::Identity());
  const Trajectory poses = trajectory_.in_map_frame(map_, submaps_, mission_.rig);
  ASSERT_THAT(poses, SizeIs(2));
  EXPECT_THAT(poses[0].world_from_body,
              PoseNear(body_pose(mission_.rig, kAhead * map_.camera_from_world(keyframes_[0])), 1e-12, 1e-12));
  EXPECT_THAT(poses[1].world_from_body, PoseNear(body_pose(mission_.rig, kAhead * moved), 1e-12, 1e-12));
}

// Odometry reports straight motion while the robot turns to the left.
TEST_F(AnchoredFrames, ShareTheErrorOfMeasuredMotion) {
  AnchoredTrajectory trajectory{DeferredRefinementOptions{}};
  const Pose first = map_.camera_from_world(keyframes_[0]);
  const Timestamp step = std::chrono::milliseconds(100);
  Pose measured, seen;  // from the first pose
  const auto camera = [&](const Pose& first_from_camera) { return inverse(first_from_camera) * first; };
  const auto anchored = [&](const Pose& camera_from_world) { return camera_from_world * inverse(first); };
  trajectory.add({Timestamp(0), keyframes_[0], anchored(camera(measured)), 0});
  std::vector<Pose> truth{seen};
  for (int i = 1; i < 10; ++i) {
    measured.translation.z() += 0.1;
    truth.push_back(truth.back() * exp_pose((Vector6() << 0.0, 0.0, 0.1, 0.0, -0.02, 0.0).finished()));
    trajectory.add({i * step, keyframes_[0], anchored(camera(measured)), 0});
  }
  measured.translation.z() += 0.1;
  seen = truth.back() * exp_pose((Vector6() << 0.0, 0.0, 0.1, 0.0, -0.02, 0.0).finished());
  trajectory.add({10 * step, keyframes_[0], anchored(camera(seen)), 0});
  trajectory.distribute_drift(0, 10, measured, map_);
  for (std::size_t i = 0; i < 10; ++i) {
    const Pose bent = first * inverse(byre::camera_from_world(map_, trajectory[i]));
    EXPECT_LT((bent.translation - truth[i].translation).norm(), 0.03) << i;  // metres; odometry is 0.1 m off
    EXPECT_LT(angle_between(bent.rotation, truth[i].rotation), 1e-6) << i;
  }
}

TEST_F(AnchoredFrames, AreReturnedOnceTheirSubmapJoinsTheMapFrame) {
  submaps_.begin_in_own_frame(7);
  trajectory_.add({time_of(keyframes_[1]), keyframes_[1], Pose{}, 1});
  EXPECT_THAT(trajectory_.in_map_frame(map_, submaps_, mission_.rig), SizeIs(2));
  submaps_.join_map_frame(submaps_.frame());
  EXPECT_THAT(trajectory_.in_map_frame(map_, submaps_, mission_.rig), SizeIs(3));
}

TEST_F(AnchoredFrames, AreDroppedIfUnconfirmed) {
  trajectory_.confirm_all();
  trajectory_.add({time_of(keyframes_[1]), keyframes_[1], Pose{}, 0});
  EXPECT_TRUE(trajectory_.has_unconfirmed());
  trajectory_.drop_unconfirmed();
  EXPECT_EQ(trajectory_.size(), 2u);
  EXPECT_FALSE(trajectory_.has_unconfirmed());
}

TEST_F(AnchoredFrames, FollowTheScaleOfTheirKeyframe) {
  trajectory_.apply_length_changes({{keyframes_[1], 2.0}});
  EXPECT_EQ(trajectory_[0].camera_from_keyframe, kAhead);
  EXPECT_THAT(trajectory_[1].camera_from_keyframe.translation, PointNear(2.0 * kAhead.translation, 1e-12));
  EXPECT_EQ(trajectory_[1].camera_from_keyframe.rotation.coeffs(), kAhead.rotation.coeffs());
}

TEST_F(AnchoredFrames, KeepTheirPoseInARotatedCameraFrame) {
  const RigRotation turn{{rotation_exp({0.02, -0.01, 0.03}), Eigen::Vector3d::Zero()}, 0, mission_.rig};
  const Pose before = camera_from_world(map_, trajectory_[1]);
  AnchoredTrajectory together = trajectory_;
  together.rotate_rig(turn, map_);
  EXPECT_THAT(together[1].camera_from_keyframe * turn.after_from_before * map_.camera_from_world(keyframes_[1]),
              PoseNear(turn.after_from_before * before, 1e-12, 1e-12));
  trajectory_.rotate_camera(turn.after_from_before);
  EXPECT_THAT(camera_from_world(map_, trajectory_[1]), PoseNear(turn.after_from_before * before, 1e-12, 1e-12));
}

TEST_F(AnchoredFrames, YieldTheVelocityFromTheLastFrame) {
  const Vector6 velocity = (Vector6() << 0.1, 0.0, 1.0, 0.0, 0.2, 0.0).finished();
  const Timestamp later = trajectory_.back().time + std::chrono::milliseconds(100);
  const Pose camera_from_map = exp_pose(0.1 * velocity) * camera_from_world(map_, trajectory_.back());
  EXPECT_LT((trajectory_.velocity_to(later, camera_from_map, map_) - velocity).norm(), 1e-9);
  EXPECT_TRUE(trajectory_.velocity_to(trajectory_.back().time, camera_from_map, map_).isZero());
}

TEST_F(AnchoredFrames, AreThinnedEvenlyExceptRecentOnes) {
  const TrajectoryOptions options{.max_poses = 40};
  AnchoredTrajectory trajectory({}, options);
  const Timestamp step = std::chrono::milliseconds(50);
  std::size_t left_out = 0;
  for (int i = 0; i < 1000; ++i) {
    trajectory.add({i * step, keyframes_[0], kAhead, 0});
    trajectory.confirm_all();
    left_out += trajectory.thin_out(trajectory.size());
    ASSERT_EQ(trajectory.size() + left_out, static_cast<std::size_t>(i + 1));
    ASSERT_LE(trajectory.size(), options.max_poses);
  }
  EXPECT_EQ(trajectory[0].time, Timestamp{});
  const std::size_t recent = trajectory.size() - options.max_poses / 2;
  const auto gap = [&](std::size_t i) { return trajectory[i].time - trajectory[i - 1].time; };
  for (std::size_t i = recent + 1; i < trajectory.size(); ++i) EXPECT_EQ(gap(i), step) << i;
  EXPECT_GE(gap(1), 20 * step);
  for (std::size_t i = 2; i < recent && gap(i) > step; ++i) {
    EXPECT_LE(gap(i), 2 * gap(1)) << i;
    EXPECT_GE(2 * gap(i), gap(1)) << i;
  }
}

TEST_F(AnchoredFrames, AreKeptWhileIndexedOrUnconfirmed) {
  AnchoredTrajectory trajectory({}, {.max_poses = 40});
  for (int i = 0; i < 100; ++i) trajectory.add({std::chrono::milliseconds(50 * i), keyframes_[0], kAhead, 0});
  EXPECT_EQ(trajectory.thin_out(trajectory.size()), 0u);
  trajectory.confirm_all();
  const std::size_t left_out = trajectory.thin_out(30);
  EXPECT_GE(left_out, 20u);
  EXPECT_EQ(trajectory[30 - left_out].time, std::chrono::milliseconds(50 * 30));
  EXPECT_EQ(trajectory.thin_out(30 - left_out), 0u) << "nothing is left to thin out";
}

TEST_F(AnchoredFrames, TakeThePoseOfTheKeyframeTheyBecome) {
  trajectory_.anchor_last_to(keyframes_[0]);
  EXPECT_EQ(trajectory_.back().keyframe, keyframes_[0]);
  EXPECT_EQ(trajectory_.back().camera_from_keyframe, Pose{});
}

}  // namespace
}  // namespace byre
