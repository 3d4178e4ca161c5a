#include "degradation.h"

#include "byre/features/image_scene.h"
#include "byre/image_condition.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kWidth = 376;
constexpr int kHeight = 240;

Image scene(std::uint64_t seed = 71) {
  return to_image(render(kWidth, kHeight, Texture(seed, 0.6)));
}

ImageFrame pair_of_images() {
  return {from_seconds(3.0), scene(71), scene(72)};
}

int grey(const Image& image, int x, int y) {
  return image.pixels[static_cast<std::size_t>(y * image.width + x)];
}

double mean_difference(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.pixels.size(); ++i) sum += std::abs(int{a.pixels[i]} - int{b.pixels[i]});
  return sum / static_cast<double>(a.pixels.size());
}

double share_unchanged(const Image& before, const Image& after) {
  const int same = std::transform_reduce(before.pixels.begin(), before.pixels.end(), after.pixels.begin(), 0,
                                         std::plus<>(), std::equal_to<>());
  return static_cast<double>(same) / static_cast<double>(before.pixels.size());
}

TEST(Degradation, EveryKindIsDeterministicAndKeepsTimes) {
  const std::vector<Degradation> all = {
      black_frames(), hand_over_the_lens(0.7), motion_blur(20.0), exposure_jumps(4, 5), blank_close_up(), haze(0.4),
      dirt(20),       contrast_loss(0.3)};
  const ImageFrame images = pair_of_images();
  for (const Degradation& degradation : all) {
    const ImageFrame first = degradation(images, 7), second = degradation(images, 7);
    EXPECT_EQ(first.time, images.time);
    EXPECT_EQ(first.left.pixels, second.left.pixels);
    EXPECT_EQ(first.right->pixels, second.right->pixels);
    EXPECT_EQ(first.left.pixels.size(), images.left.pixels.size());
    EXPECT_FALSE(degradation({images.time, images.left, std::nullopt}, 7).right) << "one camera stays one camera";
  }
}

TEST(Degradation, BlackFramesAndBlankWallsAreEmptyInBothCameras) {
  const ImageFrame black = black_frames()(pair_of_images(), 0), blank = blank_close_up()(pair_of_images(), 0);
  for (const Image& image : {black.left, *black.right}) {
    EXPECT_EQ(fault_of(measure_condition(image), {}), ImageFault::dark);
  }
  for (const Image& image : {blank.left, *blank.right}) {
    EXPECT_EQ(fault_of(measure_condition(image), {}), ImageFault::flat);
    EXPECT_GT(measure_condition(image).brightness, 150.0f);
  }
  EXPECT_NE(blank.left.pixels, blank_close_up()(pair_of_images(), 1).left.pixels)
      << "noise is independent in every image";
}

TEST(Degradation, MotionBlurSmearsAPointAlongItsPath) {
  Image point{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 0)};
  point.pixels[120 * kWidth + 180] = 200;
  const Image blurred = motion_blurred(point, 20.0, 0.0);
  EXPECT_NEAR(grey(blurred, 180, 120), 10, 1);
  EXPECT_NEAR(grey(blurred, 189, 120), 10, 1);
  EXPECT_NEAR(grey(blurred, 171, 120), 10, 1);
  EXPECT_EQ(grey(blurred, 192, 120), 0);
  EXPECT_EQ(grey(blurred, 180, 122), 0);
  const ImageFrame images = pair_of_images();
  EXPECT_NE(motion_blur(20.0)(images, 0).left.pixels, motion_blur(20.0)(images, 1).left.pixels);
}

TEST(Degradation, ExposureJumpsUpAndDownEveryFewSteps) {
  const ImageFrame images = pair_of_images();
  const Degradation jumps = exposure_jumps(4.0, 5);
  const auto brightness = [&](int step) { return measure_condition(jumps(images, step).left).brightness; };
  const float as_it_was = measure_condition(images.left).brightness;
  EXPECT_GT(brightness(0), 1.5f * as_it_was);
  EXPECT_EQ(brightness(4), brightness(0));
  EXPECT_EQ(jumps(images, 5).left.pixels, images.left.pixels);
  EXPECT_NEAR(brightness(10), as_it_was / 4.0f, 1.0f);
  EXPECT_EQ(brightness(20), brightness(0));
  EXPECT_GT(measure_condition(jumps(images, 0).left).clipped, 0.3f);
}

TEST(Degradation, AHandCoversItsShareOfTheImageAndStaysThere) {
  const ImageFrame images = pair_of_images();
  const Degradation hand = hand_over_the_lens(0.7);
  const Image resting = hand(images, 10).left;
  // The soft edge leaves slightly less than 30 % unchanged.
  EXPECT_NEAR(share_unchanged(images.left, resting), 0.27, 0.05);
  EXPECT_EQ(hand(images, 30).left.pixels, resting.pixels);
}

TEST(Degradation, AHandAppearsWithinAFewSteps) {
  const ImageFrame images = pair_of_images();
  const Degradation hand = hand_over_the_lens(0.7);
  double before = 1.0;
  for (const int step : {0, 2, 4}) {
    const double unchanged = share_unchanged(images.left, hand(images, step).left);
    EXPECT_LT(unchanged, before);
    before = unchanged;
  }
  EXPECT_EQ(hand(images, 4).left.pixels, hand(images, 5).left.pixels);
}

TEST(Degradation, AHandOccludesTheSceneAtAnotherPositionInTheRightImage) {
  ImageFrame images{{}, scene(71), scene(71)};
  const ImageFrame covered = hand_over_the_lens(0.7)(images, 10);
  ImageFrame other{{}, scene(75), scene(75)};
  const int x = static_cast<int>(0.42 * kWidth), y = static_cast<int>(0.62 * kHeight);
  EXPECT_EQ(grey(covered.left, x, y), grey(hand_over_the_lens(0.7)(other, 10).left, x, y));
  EXPECT_GT(mean_difference(covered.left, *covered.right), 2.0);
}

TEST(Degradation, HazeAndLowContrastCompressGreyValues) {
  const ImageFrame images = pair_of_images();
  const float contrast = measure_condition(images.left).contrast;
  EXPECT_NEAR(measure_condition(haze(0.4)(images, 0).left).contrast, 0.4f * contrast, 0.02f * contrast);
  EXPECT_NEAR(measure_condition(contrast_loss(0.3)(images, 0).left).contrast, 0.3f * contrast, 0.02f * contrast);
  EXPECT_GT(measure_condition(haze(0.4)(images, 0).left).brightness, 1.2f * measure_condition(images.left).brightness);
}

TEST(Degradation, DirtStaysInPlaceAndDiffersBetweenTheLenses) {
  const Image blank{kWidth, kHeight, std::vector<std::uint8_t>(kWidth * kHeight, 255)};
  const ImageFrame white{{}, blank, blank};
  const ImageFrame dirty = dirt(20)(white, 0);
  EXPECT_EQ(dirty.left.pixels, dirt(20)(white, 50).left.pixels);
  EXPECT_NE(dirty.left.pixels, dirty.right->pixels);
  EXPECT_GT(share_unchanged(white.left, dirty.left), 0.2);
  EXPECT_LT(*std::ranges::min_element(dirty.left.pixels), 180);
}

}  // namespace
}  // namespace byre
