#include "byre/features/stereo.h"

#include "byre/base/sanitizer_scene.h"
#include "byre/features/detect.h"
#include "byre/features/image_scene.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

std::vector<std::optional<StereoMatch>> match_stereo(const Pyramid& left, const Pyramid& right, const Rig& rig,
                                                     std::span<const Keypoint> keypoints,
                                                     const StereoOptions& options) {
  std::vector<std::optional<StereoMatch>> matches(keypoints.size());
  byre::match_stereo(left, right, rig, keypoints, options, matches);
  return matches;
}

constexpr int kRigWidth = 320;
constexpr int kRigHeight = 240;

Rig stereo_rig() {
  Rig rig;
  rig.width = kRigWidth;
  rig.height = kRigHeight;
  rig.focal = 200.0;
  rig.cx = 159.5;
  rig.cy = 119.5;
  rig.baseline = 0.11;
  return rig;
}

// A rectified pair; the left pixel (x, y) is at (x - disparity, y + vertical_error) in the right image.
struct Scene {
  std::function<double(double, double)> grey;
  double disparity = 0.0;
  double vertical_error = 0.0;
  double noise = 0.0;  // grey values, in both images
};

struct Pair {
  Pyramid left;
  Pyramid right;
};

Pair render_pair(const Scene& scene) {
  cv::Mat left = render(kRigWidth, kRigHeight, scene.grey);
  cv::Mat right = render(kRigWidth, kRigHeight,
                         [&](double x, double y) { return scene.grey(x + scene.disparity, y - scene.vertical_error); });
  std::mt19937 random(1);
  if (scene.noise > 0.0) {
    add_noise(left, scene.noise, random);
    add_noise(right, scene.noise, random);
  }
  Pair pair;
  build_pyramid(left, pair.left);
  build_pyramid(right, pair.right);
  return pair;
}

std::vector<Keypoint> keypoints_of(const Pyramid& pyramid, int per_octave) {
  std::vector<Keypoint> keypoints;
  for (int octave = 0; octave < kOctaves; ++octave) {
    for (const Corner& corner : detect_corners(pyramid.levels[static_cast<std::size_t>(octave)], per_octave, {})) {
      Keypoint& keypoint = keypoints.emplace_back();
      keypoint.octave = static_cast<std::uint8_t>(octave);
      keypoint.pixel = full_from_octave({static_cast<float>(corner.x), static_cast<float>(corner.y)}, octave);
    }
  }
  return keypoints;
}

// Results for the keypoints of a scene that are inside the right image.
struct StereoScore {
  int tried = 0;
  int matched = 0;
  int gross = 0;               // more than two octave pixels off
  std::vector<double> errors;  // octave pixels
  std::vector<double> errors_by_sigma;

  double share_matched() const { return static_cast<double>(matched) / tried; }
  double share_within(double sigmas) const {
    const auto inside =
        std::count_if(errors_by_sigma.begin(), errors_by_sigma.end(), [&](double error) { return error <= sigmas; });
    return static_cast<double>(inside) / static_cast<double>(errors_by_sigma.size());
  }
  double median_error() const {
    std::vector<double> sorted = errors;
    std::nth_element(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2), sorted.end());
    return sorted.at(sorted.size() / 2);
  }
};

void add_scene(const Scene& scene, StereoScore& score) {
  const Pair pair = render_pair(scene);
  const std::vector<Keypoint> keypoints = keypoints_of(pair.left, 60);
  const auto matches = match_stereo(pair.left, pair.right, stereo_rig(), keypoints, {});
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const double scale = kScaleOfOctave[keypoints[i].octave];
    constexpr double kBlock = 10.0;  // octave pixels around the match that must be inside the right image
    if (keypoints[i].pixel.x() - scene.disparity < kBlock * scale) continue;
    ++score.tried;
    if (!matches[i]) continue;
    ++score.matched;
    const double error = std::abs(matches[i]->disparity - scene.disparity);
    if (error > 2.0 * scale) ++score.gross;
    score.errors.push_back(error / scale);
    score.errors_by_sigma.push_back(error / matches[i]->sigma);
  }
}

// Disparities with various fractions of a pixel.
StereoScore match_textures(double noise, double vertical_error = 0.0) {
  StereoScore score;
  std::uint64_t seed = 30;
  for (const double disparity : {1.3, 5.0, 12.45, 23.71, 40.1, 60.62}) {
    add_scene({Texture(++seed, 0.7), disparity, vertical_error, noise}, score);
  }
  return score;
}

TEST(MatchStereo, MeasuresSubPixelDisparitiesInAllOctaves) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const StereoScore score = match_textures(0.0);
  EXPECT_GE(score.share_matched(), 0.95);
  EXPECT_LE(score.median_error(), 0.02);
  EXPECT_EQ(score.gross, 0);
}

TEST(MatchStereo, ErrsWithinItsSigmaUnderNoise) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const StereoScore slight = match_textures(2.0);
  EXPECT_GE(slight.share_matched(), 0.85);
  EXPECT_LE(slight.median_error(), 0.05);
  EXPECT_GE(slight.share_within(2.0), 0.95);
  const StereoScore strong = match_textures(6.0);
  EXPECT_GE(strong.share_within(2.0), 0.95);
  EXPECT_LE(strong.share_within(1.0), 0.97) << "sigma is not a mere upper bound";
}

TEST(MatchStereo, ToleratesRowErrorsOfHalfAPixel) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const StereoScore score = match_textures(1.0, 0.5);
  EXPECT_GE(score.share_matched(), 0.9);
  EXPECT_LE(score.median_error(), 0.05);
  EXPECT_GE(score.share_within(2.0), 0.95);
}

TEST(MatchStereo, RejectsLargeRowErrors) {
  Scene scene{Texture(41, 0.7), 12.3, 4.0};
  const Pair pair = render_pair(scene);
  const auto keypoints = keypoints_of({{pair.left.levels[0]}}, 200);
  const auto matches = match_stereo(pair.left, pair.right, stereo_rig(), keypoints, {});
  const auto found = std::count_if(matches.begin(), matches.end(), [](const auto& match) { return match.has_value(); });
  EXPECT_LE(static_cast<double>(found), 0.05 * static_cast<double>(keypoints.size()));
}

std::size_t count_matches(const Scene& scene, const StereoOptions& options = {}) {
  const Pair pair = render_pair(scene);
  const std::vector<Keypoint> keypoints = keypoints_of(pair.left, 60);
  EXPECT_GT(keypoints.size(), 100u);
  const auto matches = match_stereo(pair.left, pair.right, stereo_rig(), keypoints, options);
  EXPECT_EQ(matches.size(), keypoints.size());
  return static_cast<std::size_t>(
      std::count_if(matches.begin(), matches.end(), [](const auto& match) { return match.has_value(); }));
}

// All candidates on a row are equally good, on whole pixels or between. Only near the left border, where the search
// ends before the second copy, a match is unique and correct.
TEST(MatchStereo, RejectsARepetitivePattern) {
  for (const double period : {12.0, 16.0, 16.37, 23.7}) {
    const auto dots = [=](double x, double y) {
      const double u = std::remainder(x, period), v = std::remainder(y, period);
      return 60.0 + 150.0 * std::exp(-0.15 * (u * u + v * v));
    };
    for (const double noise : {0.0, 2.0, 5.0}) {
      StereoScore score;
      add_scene({dots, 8.0, 0.0, noise}, score);
      EXPECT_GT(score.tried, 300);
      EXPECT_LE(score.share_matched(), 0.04) << "period " << period << ", noise " << noise;
      EXPECT_EQ(score.gross, 0) << "period " << period << ", noise " << noise;
    }
  }
}

TEST(MatchStereo, MatchesDullTextures) {
  StereoScore score;
  add_scene({Texture(48, 0.2), 12.45, 0.0, 1.0}, score);
  EXPECT_GT(score.tried, 300);
  EXPECT_GE(score.share_matched(), 0.95);
  EXPECT_EQ(score.gross, 0);
}

TEST(MatchStereo, ReturnsNothingBeyondTheLargestDisparity) {
  StereoOptions near;
  near.min_depth = 1.0;  // 22 pixels
  const Scene beyond{Texture(42, 0.7), 40.0};
  EXPECT_LE(count_matches(beyond, near), 15u);
  EXPECT_GT(count_matches(beyond), 250u) << "matches exist";
}

TEST(MatchStereo, ReturnsNothingBehindInfinity) {
  EXPECT_LE(count_matches({Texture(43, 0.7), -15.0}), 15u);
}

TEST(MatchStereo, ReturnsNothingForABlankRightImage) {
  Pair pair = render_pair({Texture(44, 0.7), 10.0});
  build_pyramid(cv::Mat(kRigHeight, kRigWidth, CV_8U, cv::Scalar(120)), pair.right);
  const auto keypoints = keypoints_of(pair.left, 60);
  for (const auto& match : match_stereo(pair.left, pair.right, stereo_rig(), keypoints, {})) EXPECT_FALSE(match);
}

TEST(MatchStereo, ReturnsNothingForBlankImages) {
  const Pair blank = render_pair({[](double, double) { return 120.0; }});
  const auto keypoints = keypoints_of(render_pair({Texture(45), 0.0}).left, 60);
  for (const auto& match : match_stereo(blank.left, blank.right, stereo_rig(), keypoints, {})) EXPECT_FALSE(match);
}

TEST(MatchStereo, StaysInsideTheImagesForAllKeypoints) {
  const Pair pair = render_pair({Texture(46, 0.7), 7.3});
  std::vector<Keypoint> keypoints;
  for (int octave = 0; octave < kOctaves; octave += kOctaves - 1) {
    const cv::Mat& level = pair.left.levels[static_cast<std::size_t>(octave)];
    for (int y = 0; y < level.rows; ++y) {
      const bool near_border = y < 8 || y >= level.rows - 8;
      for (int x = 0; x < level.cols; x += near_border ? 1 : level.cols - 1) {
        Keypoint& keypoint = keypoints.emplace_back();
        keypoint.octave = static_cast<std::uint8_t>(octave);
        keypoint.pixel = full_from_octave({static_cast<float>(x), static_cast<float>(y)}, octave);
      }
    }
  }
  const auto matches = match_stereo(pair.left, pair.right, stereo_rig(), keypoints, {});
  ASSERT_EQ(matches.size(), keypoints.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    EXPECT_LT(matches[i].value_or(StereoMatch{}).disparity, keypoints[i].pixel.x() + 1.0f);
  }
}

TEST(MatchStereo, ReturnsNothingInMissingOctavesOfASmallImage) {
  const Texture texture(47);
  Pair pair;
  build_pyramid(render(60, 50, texture), pair.left);
  build_pyramid(render(60, 50, texture), pair.right);
  ASSERT_TRUE(pair.left.levels[kOctaves - 1].empty());
  Keypoint keypoint;
  keypoint.pixel = {30.0f, 25.0f};
  keypoint.octave = kOctaves - 1;
  EXPECT_FALSE(match_stereo(pair.left, pair.right, stereo_rig(), {{keypoint}}, {}).at(0));
}

}  // namespace
}  // namespace byre
