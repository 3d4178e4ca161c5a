#include "byre/slam/mapping/keyframe_policy.h"

#include "byre/slam/tracking/mission_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

class KeyframeWatchTest : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = simulate_mission(simulated_rig(), circling_trajectory(9, 10.0, 2.0, 0.1), {});
  const MapGraph map_ = true_map(mission_, 8, Origin::online);
  KeyframePolicy watch_;

  // Evidence of a frame rotated by `turn` radians from the first keyframe.
  KeyframeEvidence evidence(double turn = 0.0) const {
    HybridTrack track;
    track.tracked.reference = map_.keyframe_ids().front();
    track.tracked.camera_from_world =
        Pose{rotation_exp({0.0, turn, 0.0}), Eigen::Vector3d::Zero()} * map_.camera_from_world(track.tracked.reference);
    return watch_.evidence(track, map_, 2);
  }
  Frame without_disparities() const { return {mission_.frames[1].time, std::make_shared<const Features>()}; }
};

TEST_F(KeyframeWatchTest, CountsFramesSinceTheLastKeyframe) {
  for (int i = 0; i < 3; ++i) watch_.note_frame(mission_.frames[1], mission_.rig);
  EXPECT_EQ(evidence().frames_since_last, 3);
  watch_.restart(map_.keyframe_ids().front());
  EXPECT_EQ(evidence().frames_since_last, 0);
  EXPECT_EQ(evidence().pending, 2);
}

TEST_F(KeyframeWatchTest, CountsFramesWithoutDepthForRigsWithDepth) {
  watch_.note_frame(without_disparities(), mission_.rig);
  watch_.note_frame(without_disparities(), mission_.rig);
  EXPECT_EQ(evidence().without_depth, 2);
  watch_.note_frame(mission_.frames[1], mission_.rig);
  EXPECT_EQ(evidence().without_depth, 0);
  Rig one_camera = mission_.rig;
  one_camera.baseline = 0.0;
  watch_.note_frame(without_disparities(), one_camera);
  EXPECT_EQ(evidence().without_depth, 0);
}

TEST_F(KeyframeWatchTest, KeepsTheInliersOfTheFirstFrameOfAReference) {
  const std::vector<KeyframeId> keyframes = map_.keyframe_ids();
  watch_.note_track(keyframes[0], 200);
  watch_.note_track(keyframes[0], 150);
  EXPECT_EQ(evidence().fresh_inliers, 200);
  watch_.note_track(keyframes[1], 180);
  EXPECT_EQ(evidence().fresh_inliers, 180);
  watch_.restart(map_.keyframe_ids().front());
  watch_.note_track(keyframes[1], 170);
  EXPECT_EQ(evidence().fresh_inliers, 170);
}

// The reference in the offline map is always near.
TEST_F(KeyframeWatchTest, CountsMotionFromTheLastOnlineKeyframeWhileTheFrameShowsFewOnlinePoints) {
  HybridTrack track;
  track.tracked.reference = {Origin::offline, 0};
  track.tracked.camera_from_world = Pose{rotation_exp({0.0, 0.2, 0.0}), Eigen::Vector3d::Zero()} *
                                    map_.camera_from_world(map_.keyframe_ids().front());
  EXPECT_TRUE(needs_keyframe(track.tracked, watch_.evidence(track, map_, 0), {.min_tracked = 0, .min_frames = 0}));
  watch_.restart(map_.keyframe_ids().front());
  EXPECT_NEAR(watch_.evidence(track, map_, 0).turn, 0.2, 1e-9);
}

TEST_F(KeyframeWatchTest, MeasuresTheRotationFromTheReference) {
  EXPECT_NEAR(evidence(0.2).turn, 0.2, 1e-9);
  EXPECT_NEAR(evidence(0.2).shift_share, 0.0, 1e-9);
}

constexpr FrameCuts kNoCuts{};
constexpr FrameCuts kNoRightImage{.online_points = false, .right_image = true};
constexpr FrameCuts kFewPoints{.online_points = true, .right_image = false};

HybridTrack tracked_on(int points) {
  HybridTrack track;
  track.tracked.features.resize(static_cast<std::size_t>(points));
  return track;
}

// Evidence of a view rotated far enough for a keyframe.
KeyframeEvidence after_a_turn() {
  KeyframeEvidence evidence;
  evidence.frames_since_last = 10;
  evidence.fresh_inliers = 200;
  evidence.turn = 2.0 * KeyframeOptions{}.max_turn;
  return evidence;
}

TEST(KeyframeOfACutFrame, WaitsForTheRightImage) {
  KeyframePolicy watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.without_depth = 10 * kMaxWaitForDepth;  // as after many such frames
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(200), evidence, kNoRightImage, {}));
  EXPECT_TRUE(watch.is_short()) << "so that the next frame is not cut";
}

TEST(KeyframeOfACutFrame, IsAddedIfNothingWasCut) {
  KeyframePolicy watch;
  EXPECT_TRUE(watch.should_add_keyframe(tracked_on(200), after_a_turn(), kNoCuts, {}));
  EXPECT_FALSE(watch.is_short());
}

TEST(KeyframeOfACutFrame, WaitsForMissingDepths) {
  KeyframePolicy watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.without_depth = 1;
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(200), evidence, kNoCuts, {}));
  EXPECT_TRUE(watch.is_short());
}

// The keyframe is the only link between the map from before the loss of tracking and this place.
TEST(KeyframeOfAFoundFrame, IsAddedAfterMeasuredMotion) {
  KeyframeEvidence nothing_new = after_a_turn();
  nothing_new.turn = 0.0;
  KeyframePolicy watch;
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(180), nothing_new, kNoCuts, {}));
  watch.require_keyframe();
  EXPECT_TRUE(watch.should_add_keyframe(tracked_on(180), nothing_new, kNoCuts, {}));
  watch.restart({Origin::online, 0});
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(180), nothing_new, kNoCuts, {}));
}

TEST(KeyframeOfACutFrame, IsNotRequestedForFewPointsIfOnlinePointsWereCut) {
  KeyframePolicy watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.turn = 0.0;
  EXPECT_TRUE(watch.should_add_keyframe(tracked_on(120), evidence, kNoCuts, {}));
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(120), evidence, kFewPoints, {}));
  EXPECT_FALSE(watch.is_short());
  EXPECT_FALSE(watch.should_add_keyframe(tracked_on(50), evidence, kFewPoints, {}));
  EXPECT_TRUE(watch.is_short());
}

}  // namespace
}  // namespace byre
