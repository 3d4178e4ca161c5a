#include "byre/image_condition.h"

#include "byre/features/image_scene.h"

#include <opencv2/imgproc.hpp>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kWallWidth = 376;
constexpr int kWallHeight = 240;

// Overlapping rectangles of all sizes, with edges as in images of buildings (dead leaves model, Lee 2001).
cv::Mat wall_image(double contrast = 0.8) {
  std::mt19937 random(61);
  std::uniform_real_distribution<double> any(0.0, 1.0);
  cv::Mat image(kWallHeight, kWallWidth, CV_8U, cv::Scalar(128));
  for (int i = 0; i < 300; ++i) {
    const cv::Point corner(static_cast<int>(any(random) * kWallWidth) - 20,
                           static_cast<int>(any(random) * kWallHeight) - 20);
    const cv::Size size(static_cast<int>(16.0 / (any(random) + 0.04)), static_cast<int>(16.0 / (any(random) + 0.04)));
    const double grey = 128.0 + contrast * 150.0 * (any(random) - 0.5);
    cv::rectangle(image, cv::Rect(corner, size), cv::Scalar(grey), cv::FILLED);
  }
  return image;
}

ImageCondition condition_of(const cv::Mat& image) {
  return measure_condition(to_image(image));
}

ImageFault fault_in(const cv::Mat& image) {
  return fault_of(condition_of(image), {});
}

// The image blurred by a straight motion over a number of pixels.
cv::Mat motion_blurred(const cv::Mat& image, double pixels, double angle) {
  cv::Mat1f path(31, 31, 0.0f);
  for (double along = -pixels / 2.0; along <= pixels / 2.0; along += 0.05) {
    path(15 + static_cast<int>(std::lround(along * std::sin(angle))),
         15 + static_cast<int>(std::lround(along * std::cos(angle)))) += 1.0f;
  }
  cv::Mat blurred;
  cv::filter2D(image, blurred, CV_8U, path / cv::sum(path)[0]);
  return blurred;
}

TEST(ImageCondition, HasNoFaultInATexturedImage) {
  EXPECT_EQ(fault_in(wall_image()), ImageFault::none);
}

TEST(ImageCondition, HasNoFaultInADimNoisyImage) {
  std::mt19937 random(1);
  cv::Mat dim = wall_image() / 6.0;
  add_noise(dim, 2.0, random);
  EXPECT_EQ(fault_in(dim), ImageFault::none);
}

TEST(ImageCondition, HasNoFaultInASlightlyBlurredImage) {
  for (const double angle : {0.0, 0.8, 1.6})
    EXPECT_EQ(fault_in(motion_blurred(wall_image(), 5.0, angle)), ImageFault::none);
}

TEST(ImageCondition, IsDarkWithoutLight) {
  std::mt19937 random(2);
  cv::Mat black(kWallHeight, kWallWidth, CV_8U, cv::Scalar(2));
  EXPECT_EQ(fault_in(black), ImageFault::dark);
  add_noise(black, 2.0, random);
  EXPECT_EQ(fault_in(black), ImageFault::dark);
}

TEST(ImageCondition, IsOverexposedIfWhite) {
  EXPECT_EQ(fault_in(cv::Mat(kWallHeight, kWallWidth, CV_8U, cv::Scalar(255))), ImageFault::overexposed);
}

TEST(ImageCondition, IsFlatOnAShadedSurfaceWithoutTexture) {
  std::mt19937 random(3);
  cv::Mat surface = render(kWallWidth, kWallHeight, [](double x, double y) { return 90.0 + 0.15 * x - 0.1 * y; });
  EXPECT_EQ(fault_in(surface), ImageFault::flat);
  add_noise(surface, 3.0, random);
  EXPECT_EQ(fault_in(surface), ImageFault::flat);
}

TEST(ImageCondition, IsBlurredByMotionInAnyDirection) {
  for (double angle = 0.0; angle < 3.1; angle += 0.4) {
    EXPECT_EQ(fault_in(motion_blurred(wall_image(), 20.0, angle)), ImageFault::blurred) << angle;
  }
}

TEST(ImageCondition, SharpnessFallsWithBlurButNotWithLight) {
  const float sharp = condition_of(wall_image()).sharpness;
  EXPECT_NEAR(condition_of(wall_image(0.2)).sharpness, sharp, 0.05 * sharp);
  EXPECT_NEAR(condition_of(wall_image() * 0.5).sharpness, sharp, 0.05 * sharp);
  float before = sharp;
  for (const double pixels : {4.0, 8.0, 16.0, 30.0}) {
    const float blurred = condition_of(motion_blurred(wall_image(), pixels, 0.5)).sharpness;
    EXPECT_LT(blurred, before);
    before = blurred;
  }
}

TEST(ImageCondition, SharpEdgesHaveSharpnessOne) {
  const cv::Mat board = render(kWallWidth, kWallHeight, [](double x, double y) {
    return (static_cast<int>(x + y) / 60 + static_cast<int>(x - y + 600.0) / 60) % 2 == 0 ? 40.0 : 200.0;
  });
  EXPECT_NEAR(condition_of(board).sharpness, 1.0, 0.15);
}

TEST(ImageCondition, ContrastGrowsWithLightButNotWithNoise) {
  std::mt19937 random(4);
  const float clean = condition_of(wall_image(0.5)).contrast;
  EXPECT_NEAR(condition_of(wall_image(0.25)).contrast, 0.5 * clean, 0.05 * clean);
  cv::Mat noisy = wall_image(0.5);
  add_noise(noisy, 5.0, random);
  EXPECT_NEAR(condition_of(noisy).contrast, clean, 0.05 * clean);
}

TEST(ImageCondition, MeasuresBrightnessAndClippedShare) {
  cv::Mat image(kWallHeight, kWallWidth, CV_8U, cv::Scalar(100));
  image.colRange(0, kWallWidth / 4) = 255;
  image.colRange(kWallWidth / 4, kWallWidth / 2) = 0;
  EXPECT_FLOAT_EQ(condition_of(image).clipped, 0.5f);
  EXPECT_FLOAT_EQ(condition_of(image).brightness, (255.0f + 0.0f + 200.0f) / 4.0f);
}

TEST(ImageCondition, MeasuresOnlyBrightnessOfATinyImage) {
  const ImageCondition tiny = condition_of(wall_image()(cv::Rect(0, 0, 32, 16)));
  EXPECT_GT(tiny.brightness, 50.0f);
  EXPECT_EQ(tiny.sharpness, 0.0f);
  EXPECT_EQ(measure_condition(Image{}).brightness, 0.0f);
}

TEST(ImageCondition, ReportsTheFirstFault) {
  ImageCondition condition{100.0f, 0.0f, 0.0f, 0.0f};
  EXPECT_EQ(fault_of(condition, {}), ImageFault::flat);
  condition.brightness = 0.0f;
  EXPECT_EQ(fault_of(condition, {}), ImageFault::dark);
  condition = {100.0f, 20.0f, 0.0f, 0.1f};
  EXPECT_EQ(fault_of(condition, {}), ImageFault::blurred);
  EXPECT_EQ(to_string(ImageFault::blurred), "blurred");
  EXPECT_EQ(to_string(ImageFault::none), "none");
}

TEST(ImageCondition, DistinguishesNoiseFromTexture) {
  for (const double sigma : {0.0, 2.0, 6.0}) {
    std::mt19937 random(3);
    cv::Mat image = wall_image();
    add_noise(image, sigma, random);
    EXPECT_NEAR(condition_of(image).noise, sigma, 0.15 * sigma + 0.4) << sigma;
  }
}

}  // namespace
}  // namespace byre
