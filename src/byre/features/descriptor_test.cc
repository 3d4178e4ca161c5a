#include "byre/features/descriptor.h"

#include "byre/features/brief_pattern.h"
#include "byre/features/image_scene.h"

#include <cmath>
#include <cstddef>
#include <cstring>
#include <numbers>

#include <gtest/gtest.h>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

namespace byre {
namespace {

cv::Mat blur(const cv::Mat& image) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(7, 7), 2.0, 2.0, cv::BORDER_REFLECT_101);
  return blurred;
}

std::ptrdiff_t stride(const cv::Mat& image) {
  return static_cast<std::ptrdiff_t>(image.step);
}

const std::uint8_t* at(const cv::Mat& image, const cv::Point2f& pixel) {
  return image.ptr<std::uint8_t>(static_cast<int>(pixel.y)) + static_cast<int>(pixel.x);
}

struct OrbFeatures {
  std::vector<cv::KeyPoint> keypoints;  // on whole pixels, because there is one octave
  cv::Mat descriptors;

  Descriptor descriptor(std::size_t i) const {
    Descriptor descriptor;
    std::memcpy(descriptor.data(), descriptors.ptr(static_cast<int>(i)), sizeof descriptor);
    return descriptor;
  }
};

OrbFeatures orb_features(const cv::Mat& image) {
  const auto orb = cv::ORB::create(500, 1.2f, 1);
  OrbFeatures features;
  orb->detectAndCompute(image, cv::noArray(), features.keypoints, features.descriptors);
  return features;
}

double turn_between(double a, double b) {
  return std::abs(std::remainder(a - b, 2.0 * std::numbers::pi));
}

cv::Mat textured_image() {
  return render(400, 300, Texture(11));
}

TEST(Orientation, AgreesWithOrb) {
  const cv::Mat image = textured_image();
  const OrbFeatures orb = orb_features(image);
  ASSERT_GT(orb.keypoints.size(), 300u);
  const double precision = 0.3 * std::numbers::pi / 180.0;  // precision of cv::fastAtan2, which ORB uses; radians
  for (const cv::KeyPoint& keypoint : orb.keypoints) {
    const double expected = keypoint.angle * std::numbers::pi / 180.0;
    EXPECT_LE(turn_between(orientation(at(image, keypoint.pt), stride(image)), expected), precision);
  }
}

TEST(Orientation, PointsTowardsTheBrightSide) {
  const auto brighter_towards = [](double angle) {
    return render(41, 41, [&](double x, double y) {
      return 128.0 + 4.0 * ((x - 20.0) * std::cos(angle) + (y - 20.0) * std::sin(angle));
    });
  };
  for (double angle = -3.0; angle <= 3.0; angle += 0.5) {
    const cv::Mat image = brighter_towards(angle);
    EXPECT_LE(turn_between(orientation(at(image, {20, 20}), stride(image)), angle), 0.01) << angle;
  }
}

// Reference implementation without vectors.
Descriptor reference_descriptor(const std::uint8_t* blurred_centre, std::ptrdiff_t stride, float angle) {
  const float cosine = std::cos(angle), sine = std::sin(angle);
  const auto grey = [&](std::size_t point) {
    const auto x = static_cast<float>(kBriefPattern[2 * point]), y = static_cast<float>(kBriefPattern[2 * point + 1]);
    const auto column = static_cast<std::ptrdiff_t>(std::nearbyint(x * cosine - y * sine));
    const auto row = static_cast<std::ptrdiff_t>(std::nearbyint(x * sine + y * cosine));
    return blurred_centre[row * stride + column];
  };
  Descriptor descriptor{};
  for (std::size_t pair = 0; pair < 256; ++pair) {
    if (grey(2 * pair) < grey(2 * pair + 1)) descriptor[pair / 64] |= 1ull << (pair % 64);
  }
  return descriptor;
}

TEST(Describe, MatchesTheReferenceBitForBit) {
  const cv::Mat image = white_noise({61, 47}, 3);
  for (float angle = -3.2f; angle < 3.2f; angle += 0.01f) {
    EXPECT_EQ(describe(at(image, {30, 23}), stride(image), angle),
              reference_descriptor(at(image, {30, 23}), stride(image), angle))
        << angle;
  }
}

// Rotated points of the pattern are rounded to pixels. A fused multiply-add rounds only once, so that a point may fall
// on the next pixel: a few bits of a few descriptors may differ.
TEST(Describe, AgreesWithOrbAtTheSameAngle) {
  const cv::Mat image = textured_image();
  const cv::Mat blurred = blur(image);
  const OrbFeatures orb = orb_features(image);
  ASSERT_GT(orb.keypoints.size(), 300u);
  std::size_t equal = 0;
  for (std::size_t i = 0; i < orb.keypoints.size(); ++i) {
    const cv::KeyPoint& keypoint = orb.keypoints[i];
    const float angle = keypoint.angle * static_cast<float>(std::numbers::pi / 180.0);
    const int distance =
        hamming_distance(describe(at(blurred, keypoint.pt), stride(blurred), angle), orb.descriptor(i));
    EXPECT_LE(distance, 2);
    equal += distance == 0 ? 1 : 0;
  }
  EXPECT_GE(static_cast<double>(equal), 0.85 * static_cast<double>(orb.keypoints.size()));
}

TEST(Describe, StaysNearOrbAtItsOwnAngle) {
  const cv::Mat image = textured_image();
  const cv::Mat blurred = blur(image);
  const OrbFeatures orb = orb_features(image);
  double sum = 0.0;
  for (std::size_t i = 0; i < orb.keypoints.size(); ++i) {
    const cv::Point2f pixel = orb.keypoints[i].pt;
    const float angle = orientation(at(image, pixel), stride(image));
    const int distance = hamming_distance(describe(at(blurred, pixel), stride(blurred), angle), orb.descriptor(i));
    EXPECT_LE(distance, 12);
    sum += distance;
  }
  EXPECT_LE(sum / static_cast<double>(orb.keypoints.size()), 2.0);
}

TEST(Describe, IsNearlyInvariantToRotation) {
  const Texture texture(12);
  double sum = 0.0, sum_unlike = 0.0;
  constexpr int kPlaces = 50;
  for (int place = 0; place < kPlaces; ++place) {
    const double angle = 0.13 * place;
    const auto describe_view = [&](double centre, double turn) {
      const cv::Mat image = render(61, 61, [&](double x, double y) {
        const double u = x - 30.0, v = y - 30.0;
        return texture(centre + std::cos(turn) * u - std::sin(turn) * v, std::sin(turn) * u + std::cos(turn) * v);
      });
      const cv::Mat blurred = blur(image);
      return describe(at(blurred, {30, 30}), stride(blurred), orientation(at(image, {30, 30}), stride(image)));
    };
    const Descriptor upright = describe_view(100.0 * place, 0.0);
    sum += hamming_distance(upright, describe_view(100.0 * place, angle));
    sum_unlike += hamming_distance(upright, describe_view(100.0 * place + 50.0, 0.0));
  }
  EXPECT_LE(sum / kPlaces, 30.0);
  EXPECT_GE(sum_unlike / kPlaces, 90.0);
}

TEST(HammingDistance, CountsDifferingBits) {
  const Descriptor zeros{};
  const Descriptor ones{~0ull, ~0ull, ~0ull, ~0ull};
  EXPECT_EQ(hamming_distance(zeros, zeros), 0);
  EXPECT_EQ(hamming_distance(zeros, ones), 256);
  EXPECT_EQ(hamming_distance(zeros, {1, 2, 4, 1ull << 63}), 4);
}

}  // namespace
}  // namespace byre
