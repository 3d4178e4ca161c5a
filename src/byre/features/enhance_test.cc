#include "byre/features/enhance.h"

#include "byre/features/image_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

cv::Mat steps(double contrast) {
  cv::Mat image(240, 376, CV_8U);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      image.at<std::uint8_t>(y, x) = cv::saturate_cast<std::uint8_t>(30.0 + ((x / 24 + y / 24) % 2) * contrast);
    }
  }
  return image;
}

cv::Mat noisy(const cv::Mat& image, double sigma) {
  std::mt19937 random(7);
  cv::Mat with_noise = image.clone();
  add_noise(with_noise, sigma, random);
  return with_noise;
}

TEST(Enhancement, LeavesWellLitImages) {
  EXPECT_FALSE(choose_enhancement({.brightness = 100.0f, .contrast = 20.0f, .noise = 3.4f}).is_active());
}

TEST(Enhancement, LeavesBlankImages) {
  EXPECT_FALSE(choose_enhancement({.brightness = 1.0f, .contrast = 0.2f, .noise = 5.0f}).is_active());
}

TEST(Enhancement, SmoothsExcessNoise) {
  const cv::Mat image = noisy(steps(60.0), 8.0);
  const Enhancement enhancement = choose_enhancement(measure_condition(to_image(image)));
  EXPECT_EQ(enhancement.gain, 1.0f);
  cv::Mat fine, smooth;
  enhance(enhancement, image, fine, smooth);
  // Inside a uniform field, which contains only noise.
  cv::Scalar mean, deviation;
  cv::meanStdDev(smooth(cv::Rect(100, 100, 16, 16)), mean, deviation);
  EXPECT_NEAR(deviation[0], 2.5, 0.8);
}

TEST(Enhancement, BrightensDarkPartsBesideWindows) {
  cv::Mat image = steps(6.0) - 22.0;  // grey values of 8 and 14
  image(cv::Rect(0, 0, 188, 8)).setTo(255);
  const ImageCondition condition = measure_condition(to_image(noisy(image, 1.0)));
  const Enhancement enhancement = choose_enhancement(condition);
  EXPECT_TRUE(enhancement.uses_square_root);
  cv::Mat fine, bright;
  enhance(enhancement, image, fine, bright);
  const int dark = bright.at<std::uint8_t>(100, 100), light = bright.at<std::uint8_t>(100, 125);
  EXPECT_NEAR(std::abs(light - dark), 10, 2) << "twice the contrast in the dark, reduced by the root";
  EXPECT_GE(bright.at<std::uint8_t>(5, 100), 250);
  EXPECT_LT(dark, 40) << "black stays black";
}

TEST(Enhancement, SmoothsInProportionToAmplification) {
  const Enhancement enhancement = choose_enhancement({.brightness = 10.0f, .contrast = 9.0f, .noise = 4.7f});
  EXPECT_TRUE(enhancement.uses_square_root);
  EXPECT_EQ(enhancement.gain, 2.0f);
  EXPECT_NEAR(enhancement.smoothing, 1.06f, 0.01f);
  EXPECT_FALSE(choose_enhancement({.brightness = 35.0f, .contrast = 25.0f, .noise = 5.5f}).uses_square_root);
}

// Expects the condition of the enhanced image to be predicted; returns the enhancement.
Enhancement expect_predicted(const cv::Mat& image) {
  const ImageCondition condition = measure_condition(to_image(image));
  const Enhancement enhancement = choose_enhancement(condition);
  cv::Mat fine, bright;
  enhance(enhancement, image, fine, bright);
  const ImageCondition after = measure_condition(to_image(bright));
  const ImageCondition predicted = condition_after_enhancement(enhancement, condition);
  EXPECT_NEAR(after.brightness, predicted.brightness, 2.0f);
  EXPECT_NEAR(after.contrast, predicted.contrast, 0.25f * predicted.contrast);
  return enhancement;
}

TEST(Enhancement, PredictsTheDarkResponse) {
  EXPECT_TRUE(expect_predicted(noisy(steps(5.0) - 22.0, 1.0)).uses_square_root);
}

TEST(Enhancement, StretchesDullImages) {
  EXPECT_GT(expect_predicted(noisy(steps(5.0), 1.0)).gain, 3.0f);
}

}  // namespace
}  // namespace byre
