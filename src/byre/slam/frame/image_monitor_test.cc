#include "byre/slam/frame/image_monitor.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

const Rig kRig = [] {
  Rig rig;
  rig.width = 640;
  rig.height = 480;
  return rig;
}();

constexpr ImageCondition kGoodImage{100.0f, 20.0f, 0.0f, 0.8f};
constexpr ImageCondition kBlackImage{1.0f, 0.2f, 1.0f, 0.0f};

// A pair with `matched` of 200 features matched in the right image, at this row offset.
Frame pair_with(int matched, float row_offset) {
  std::vector<Keypoint> keypoints(200);
  for (int i = 0; i < matched; ++i) {
    Keypoint& keypoint = keypoints[static_cast<std::size_t>(i)];
    keypoint.disparity = 10.0f;
    keypoint.disparity_sigma = 0.2f;
    keypoint.row_offset = i % 2 == 0 ? row_offset : -row_offset;
  }
  Frame frame;
  frame.features = std::make_shared<const Features>(640, 480, keypoints, std::vector<Descriptor>(keypoints.size()),
                                                    std::vector<Patch>{});
  frame.condition = frame.right_condition = kGoodImage;
  return frame;
}

Frame at(double seconds, std::uint64_t content) {
  Frame frame = pair_with(120, 0.2f);
  frame.time = from_seconds(seconds);
  frame.content = content;
  return frame;
}

bool disagree_after(int frames, const Frame& frame) {
  ImageMonitor watch({});
  bool disagree = false;
  for (int i = 0; i < frames; ++i) disagree = watch.check(frame, kRig).cameras_disagree;
  return disagree;
}

TEST(ImageMonitor, MeasuresTheDurationOfARepeatedImage) {
  ImageMonitor watch({});
  EXPECT_FALSE(watch.check(at(0.0, 7), kRig).is_repeated);
  EXPECT_FALSE(watch.check(at(0.1, 8), kRig).is_repeated);
  const InputEvidence once = watch.check(at(0.2, 8), kRig);
  EXPECT_TRUE(once.is_repeated);
  EXPECT_NEAR(once.frozen_seconds, 0.1, 1e-9);
  EXPECT_NEAR(watch.check(at(0.3, 8), kRig).frozen_seconds, 0.2, 1e-9);
  const InputEvidence moving = watch.check(at(0.4, 9), kRig);
  EXPECT_FALSE(moving.is_repeated);
  EXPECT_EQ(moving.frozen_seconds, 0.0);
}

TEST(ImageMonitor, IgnoresSimulatedFramesWithoutImages) {
  ImageMonitor watch({});
  watch.check(at(0.0, 0), kRig);
  EXPECT_FALSE(watch.check(at(0.1, 0), kRig).is_repeated);
}

TEST(ImageMonitor, AcceptsMatchingPairs) {
  EXPECT_FALSE(disagree_after(10, pair_with(90, 0.3f)));
  EXPECT_FALSE(disagree_after(10, pair_with(80, 0.7f))) << "errors of a worn calibration";
}

TEST(ImageMonitor, DetectsPairsWithoutMatchesOrOnOtherRows) {
  EXPECT_TRUE(disagree_after(1, pair_with(4, 0.3f)));
  EXPECT_TRUE(disagree_after(1, pair_with(90, 1.0f)));
}

TEST(ImageMonitor, IgnoresPairsHiddenByDirt) {
  Frame frame = pair_with(0, 0.0f);
  std::vector<Keypoint> keypoints = to_vector(frame.features->keypoints());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    keypoints[i].pixel = {static_cast<float>(i % 20) * 32.0f, static_cast<float>(i / 20) * 48.0f};
    if (keypoints[i].pixel.x() > 32.0f) continue;  // dirt hides the rest
    keypoints[i].disparity = 10.0f;
    keypoints[i].disparity_sigma = 0.2f;
    keypoints[i].row_offset = 0.2f;
  }
  frame.features = std::make_shared<const Features>(640, 480, keypoints, to_vector(frame.features->descriptors()),
                                                    std::vector<Patch>{});
  EXPECT_FALSE(disagree_after(10, frame));
}

TEST(ImageMonitor, ToleratesOneBadPairAmongGoodOnes) {
  ImageMonitor watch({});
  for (int i = 0; i < 5; ++i) watch.check(pair_with(120, 0.2f), kRig);
  EXPECT_FALSE(watch.check(pair_with(4, 0.2f), kRig).cameras_disagree);
}

TEST(ImageMonitor, DetectsABlindRightCamera) {
  ImageMonitor watch({});
  Frame frame = pair_with(0, 0.0f);
  frame.right_condition = kBlackImage;
  const InputEvidence evidence = watch.check(frame, kRig);
  EXPECT_EQ(evidence.right_fault, ImageFault::dark);
  EXPECT_FALSE(evidence.cameras_disagree);
}

TEST(ImageMonitor, DoesNotBlameTheRightImageForABlindLeftOne) {
  ImageMonitor watch({});
  Frame frame = pair_with(0, 0.0f);
  frame.condition = frame.right_condition = kBlackImage;
  const InputEvidence evidence = watch.check(frame, kRig);
  EXPECT_EQ(evidence.right_fault, ImageFault::none);
  EXPECT_FALSE(evidence.cameras_disagree);
}

TEST(ImageMonitor, IgnoresSingleCameras) {
  ImageMonitor watch({});
  Frame frame = pair_with(0, 0.0f);
  frame.right_condition.reset();
  EXPECT_FALSE(watch.check(frame, kRig).cameras_disagree);
}

}  // namespace
}  // namespace byre
