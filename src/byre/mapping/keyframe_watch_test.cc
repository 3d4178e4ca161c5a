#include "byre/mapping/keyframe_watch.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr FrameCuts kNoCuts{};
constexpr FrameCuts kNoRightImage{.online_points = false, .right_image = true};
constexpr FrameCuts kFewPoints{.online_points = true, .right_image = false};

HybridTrack tracked_on(int points) {
  HybridTrack track;
  track.tracked.features.resize(static_cast<std::size_t>(points));
  return track;
}

// A view that has turned far enough for a keyframe.
KeyframeEvidence after_a_turn() {
  KeyframeEvidence evidence;
  evidence.frames_since_last = 10;
  evidence.fresh_inliers = 200;
  evidence.turn = 2.0 * KeyframeOptions{}.max_turn;
  return evidence;
}

TEST(KeyframeWatch, MakesNoKeyframeWithoutARightImageThatWasLeftOut) {
  KeyframeWatch watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.without_depth = 10 * kMaxWaitForDepth;  // as after many such frames
  EXPECT_FALSE(watch.asks_for_keyframe(tracked_on(200), evidence, kNoRightImage, {}));
  EXPECT_TRUE(watch.is_short()) << "so that the next frame is seen whole";
}

TEST(KeyframeWatch, MakesAKeyframeOfAFrameThatWasSeenWhole) {
  KeyframeWatch watch;
  EXPECT_TRUE(watch.asks_for_keyframe(tracked_on(200), after_a_turn(), kNoCuts, {}));
  EXPECT_FALSE(watch.is_short());
}

TEST(KeyframeWatch, WaitsForDepthsWhereTheyWereMissing) {
  KeyframeWatch watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.without_depth = 1;
  EXPECT_FALSE(watch.asks_for_keyframe(tracked_on(200), evidence, kNoCuts, {}));
  EXPECT_TRUE(watch.is_short());
}

TEST(KeyframeWatch, TakesFewPointsForNoNewViewWhereFewWereLookedFor) {
  KeyframeWatch watch;
  KeyframeEvidence evidence = after_a_turn();
  evidence.turn = 0.0;
  EXPECT_TRUE(watch.asks_for_keyframe(tracked_on(120), evidence, kNoCuts, {}));
  EXPECT_FALSE(watch.asks_for_keyframe(tracked_on(120), evidence, kFewPoints, {}));
  EXPECT_FALSE(watch.is_short());
  EXPECT_FALSE(watch.asks_for_keyframe(tracked_on(50), evidence, kFewPoints, {}));
  EXPECT_TRUE(watch.is_short());
}

}  // namespace
}  // namespace byre
