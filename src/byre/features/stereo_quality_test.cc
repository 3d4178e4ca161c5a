#include "byre/features/stereo_quality.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

Rig image_of(int width, int height) {
  Rig rig;
  rig.width = width;
  rig.height = height;
  return rig;
}

// Features all over an image of 800 x 600 pixels; those left of a column are matched in the right image.
Features found_left_of(float column) {
  std::vector<Keypoint> keypoints;
  for (float v = 10.0f; v < 600.0f; v += 20.0f) {
    for (float u = 10.0f; u < 800.0f; u += 20.0f) {
      Keypoint& keypoint = keypoints.emplace_back(Keypoint{{u, v}});
      if (u >= column) continue;
      keypoint.disparity = 10.0f;
      keypoint.disparity_sigma = 0.2f;
    }
  }
  const std::vector<Descriptor> descriptors(keypoints.size());
  return {800, 600, std::move(keypoints), descriptors, {}};
}

TEST(StereoQuality, IsGoodForImagesWithEnoughCommonRows) {
  EXPECT_TRUE(is_consistent({.matched = 0.4, .best_match_rate = 0.8, .row_error = 0.7}));
  EXPECT_FALSE(is_consistent({.matched = 0.4, .best_match_rate = 0.8, .row_error = 0.9}));
  EXPECT_FALSE(is_consistent({.matched = 0.1, .best_match_rate = 0.1, .row_error = 0.2}));
}

TEST(StereoQuality, IsGoodForSoiledLensesInTheCleanParts) {
  constexpr StereoQuality kSoiled{.matched = 0.08, .best_match_rate = 0.4, .row_error = 0.3};
  EXPECT_TRUE(is_consistent(kSoiled));
  EXPECT_TRUE(is_partly_hidden(kSoiled));
  EXPECT_FALSE(is_partly_hidden({.matched = 0.4, .best_match_rate = 0.8, .row_error = 0.3}));
}

TEST(StereoQuality, IsBadForARotatedCameraDespiteSomeMatches) {
  EXPECT_FALSE(is_consistent({.matched = 0.08, .best_match_rate = 0.4, .row_error = 0.7}));
}

TEST(MatchRateGrid, IsTheLargestShareOfAPart) {
  const Rig rig = image_of(800, 600);
  MatchRateGrid matched(1.0);
  EXPECT_EQ(matched.best_rate(), 0.0);
  matched.note(found_left_of(100.0f), rig);
  EXPECT_EQ(matched.best_rate(), 1.0) << "one of eight columns of parts is a tenth";
  MatchRateGrid nothing(1.0);
  nothing.note(found_left_of(0.0f), rig);
  EXPECT_EQ(nothing.best_rate(), 0.0);
}

TEST(MatchRateGrid, ForgetsEarlierFrames) {
  const Rig rig = image_of(800, 600);
  MatchRateGrid remembers(1.0), forgets(0.5);
  for (MatchRateGrid* matched : {&remembers, &forgets}) {
    matched->note(found_left_of(800.0f), rig);
    for (int i = 0; i < 3; ++i) matched->note(found_left_of(0.0f), rig);
  }
  EXPECT_NEAR(remembers.best_rate(), 1.0 / 4.0, 1e-9);
  EXPECT_NEAR(forgets.best_rate(), 0.125 / 1.875, 1e-9);
}

// Features all over an image of 800 x 600 pixels, with different row offsets in its upper and lower part.
Features off_their_row(float above, float below) {
  std::vector<Keypoint> keypoints;
  for (float v = 10.0f; v < 600.0f; v += 20.0f) {
    for (float u = 10.0f; u < 800.0f; u += 20.0f) {
      Keypoint& keypoint = keypoints.emplace_back(Keypoint{{u, v}});
      keypoint.disparity = 10.0f;
      keypoint.disparity_sigma = 0.2f;
      keypoint.row_offset = v < 400.0f ? above : below;
    }
  }
  const std::vector<Descriptor> descriptors(keypoints.size());
  return {800, 600, std::move(keypoints), descriptors, {}};
}

TEST(CommonRowError, IsTheRootMeanSquareOverRegions) {
  CommonRowError error;
  EXPECT_FALSE(error.pixels());
  const Rig rig = image_of(800, 600);
  error.note(off_their_row(0.0f, 0.0f), rig);
  EXPECT_NEAR(error.pixels().value(), 0.0, 0.011);
  for (int i = 0; i < 3; ++i) error.note(off_their_row(-0.3f, 0.6f), rig);
  EXPECT_NEAR(error.pixels().value(), std::sqrt((2.0 * 0.09 + 0.36) / 3.0), 0.02) << "by the median of each region";
}

TEST(CommonRowError, IsEmptyWithoutMatches) {
  CommonRowError error;
  error.note(found_left_of(0.0f), image_of(800, 600));
  EXPECT_FALSE(error.pixels());
}

}  // namespace
}  // namespace byre
