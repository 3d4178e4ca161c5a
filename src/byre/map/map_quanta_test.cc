#include "byre/map/map_quanta.h"

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Eigenvalues>
#include <gmock/gmock.h>

namespace byre {
namespace {

float between(std::mt19937_64& random, float low, float high) {
  return std::uniform_real_distribution<float>(low, high)(random);
}

TEST(MapQuanta, RoundPixelsToOne128th) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 10000; ++i) {
    const float coordinate = between(random, -0.5f, 751.5f);
    const std::uint32_t code = pixel_code(coordinate, 752);
    EXPECT_LT(code, pixel_codes(752));
    EXPECT_NEAR(coordinate_of(code), coordinate, 1.0 / 128.0 + 1e-4);
    EXPECT_EQ(pixel_code(coordinate_of(code), 752), code);
  }
}

TEST(MapQuanta, KeepPixelsInTheirGridCell) {
  for (const float edge : {16.0f, 32.0f, 700.0f, 1232.0f}) {
    const float before = std::nextafter(edge, 0.0f);
    EXPECT_LT(coordinate_of(pixel_code(before, 1241)), edge);
    EXPECT_GE(coordinate_of(pixel_code(edge, 1241)), edge);
  }
}

TEST(MapQuanta, KeepPixelsInTheImage) {
  EXPECT_GE(coordinate_of(pixel_code(-0.5f, 640)), -0.5f);
  EXPECT_LE(coordinate_of(pixel_code(639.5f, 640)), 639.5f);
  EXPECT_LE(coordinate_of(pixel_code(16383.5f, 16384)), 16383.5f);
}

TEST(MapQuanta, RoundOffsetsToOne256th) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 10000; ++i) {
    const float offset = between(random, -40.0f, 40.0f);
    const std::uint32_t code = offset_code(offset);
    EXPECT_NEAR(offset_of(code), offset, 1.0 / 256.0 + 1e-5);
    EXPECT_EQ(offset_code(offset_of(code)), code);
  }
  EXPECT_EQ(offset_code(0.0f), 0u);
  EXPECT_EQ(offset_code(1e30f), kLargestOffsetCode - 1);
  EXPECT_EQ(offset_code(-1e30f), kLargestOffsetCode);
  for (const std::uint32_t code : {kLargestOffsetCode - 1, kLargestOffsetCode}) {
    EXPECT_EQ(offset_code(offset_of(code)), code);
  }
}

TEST(MapQuanta, ReproduceTheCodeOfEverySigma) {
  for (int code = 1; code < 256; ++code) {
    EXPECT_EQ(sigma_code(sigma_of_code(static_cast<std::uint8_t>(code))), code);
  }
  EXPECT_NEAR(sigma_of_code(sigma_code(0.15f)), 0.15, 0.15 * 0.022);
  EXPECT_NEAR(sigma_of_code(sigma_code(1e-30f)), 1.0 / 256.0, 2e-4);
  EXPECT_GT(sigma_of_code(sigma_code(1e30f)), 200.0f);
}

TEST(MapQuanta, RoundNumbersToFewerDigits) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 10000; ++i) {
    const float value = std::exp(between(random, -20.0f, 20.0f));
    EXPECT_NEAR(float_of_24(float24_code(value)), value, value / (1 << 16));
    EXPECT_NEAR(float_of_16(float16_code(value)), value, value / (1 << 8));
    EXPECT_EQ(float24_code(float_of_24(float24_code(value))), float24_code(value));
    EXPECT_EQ(float16_code(float_of_16(float16_code(value))), float16_code(value));
    EXPECT_NEAR(double_of_48(double48_code(-5e6 * value)), -5e6 * value, 5e6 * value * std::ldexp(1.0, -36));
  }
  EXPECT_TRUE(std::isfinite(float_of_16(float16_code(std::numeric_limits<float>::max()))));
  EXPECT_TRUE(std::isfinite(float_of_24(float24_code(std::numeric_limits<float>::max()))));
  EXPECT_TRUE(std::isfinite(double_of_48(double48_code(std::numeric_limits<double>::max()))));
}

TEST(MapQuanta, KeepDirectionsOfUnitLength) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 10000; ++i) {
    const Eigen::Vector3f direction =
        Eigen::Vector3f(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1)).normalized();
    const DirectionCode code = direction_code(direction * between(random, 0.9991f, 1.0009f));
    EXPECT_NEAR(direction_of(code).norm(), 1.0, 6e-4);
    EXPECT_LT((direction_of(code) - direction).norm(), 1e-3f);
    EXPECT_EQ(direction_code(direction_of(code)), code);
  }
}

// Elongated along a random direction, like covariances of points with uncertain depth.
Eigen::Matrix3d elongated(std::mt19937_64& random, double long_sigma, double short_sigma) {
  const Eigen::Vector3d direction =
      Eigen::Vector3f(between(random, -1, 1), between(random, -1, 1), between(random, -1, 1))
          .cast<double>()
          .normalized();
  return short_sigma * short_sigma * Eigen::Matrix3d::Identity() +
         long_sigma * long_sigma * direction * direction.transpose();
}

TEST(MapQuanta, KeepCovariancesPositiveDefiniteAndRoundOnce) {
  std::mt19937_64 random(5);
  for (int i = 0; i < 10000; ++i) {
    const double ratio = std::pow(10.0, between(random, 0.0f, 3.0f));
    const Eigen::Matrix3d covariance = elongated(random, 0.01 * ratio, 0.01);
    const CovarianceCode code = covariance_code(covariance);
    const Eigen::Matrix3d rounded = covariance_of(code).value();
    EXPECT_EQ(covariance_code(rounded), code);
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(rounded);
    EXPECT_NEAR(std::sqrt(solver.eigenvalues()[0]), 0.01, 0.01 * 5e-5 * ratio);
    EXPECT_NEAR(std::sqrt(solver.eigenvalues()[2]), 0.01 * std::hypot(ratio, 1.0), 1e-4 * ratio);
  }
}

TEST(MapQuanta, AcceptDegenerateCovariances) {
  for (const Eigen::Matrix3d& covariance :
       {Eigen::Matrix3d(Eigen::Matrix3d::Zero()), Eigen::Matrix3d(-Eigen::Matrix3d::Identity()),
        Eigen::Matrix3d(Eigen::Matrix3d::Constant(1.0)), Eigen::Matrix3d(Eigen::Matrix3d::Constant(1e308)),
        Eigen::Matrix3d(1e-300 * Eigen::Matrix3d::Identity())}) {
    const CovarianceCode code = covariance_code(covariance);
    const auto rounded = covariance_of(code);
    ASSERT_TRUE(rounded.has_value());
    EXPECT_TRUE(rounded->allFinite());
    EXPECT_EQ(covariance_code(*rounded), code);
  }
}

TEST(MapQuanta, RejectInvalidCovarianceCodes) {
  EXPECT_FALSE(covariance_of({{-20000, 0, 1, 0, 0, 1}, 0}));  // a negative pivot
  EXPECT_FALSE(covariance_of({{0, 20000, 1, 0, 0, 1}, 0}));   // a non-zero entry below a zero pivot
  EXPECT_FALSE(covariance_of({{1, 0, 1, 0, 0, 1}, 0}));       // not the smallest exponent
  EXPECT_FALSE(covariance_of({{32767, -32768, 1, 0, 0, 1}, 0}));
  EXPECT_TRUE(covariance_of({{32767, -32767, 1, 0, 0, 1}, 0}));
}

Patch random_patch(std::mt19937_64& random, int darkest, int range) {
  Patch patch;
  for (std::uint8_t& grey : patch.pixels) {
    grey = static_cast<std::uint8_t>(darkest + static_cast<int>(random() % static_cast<unsigned>(range + 1)));
  }
  patch.centre << between(random, 7.0f, 9.0f), between(random, 7.0f, 9.0f);
  return patch;
}

TEST(MapQuanta, ReserveCodesForInvalidValues) {
  constexpr float kNoNumber = std::numeric_limits<float>::quiet_NaN();
  for (const float outside : {kNoNumber, -0.6f, 639.6f, 1e30f, -1e30f})
    EXPECT_EQ(pixel_code(outside, 640), pixel_codes(640));
  EXPECT_GT(offset_code(kNoNumber), kLargestOffsetCode);
  for (const float sigma : {kNoNumber, 0.0f, -1.0f, std::numeric_limits<float>::infinity()}) {
    EXPECT_EQ(sigma_of_code(sigma_code(sigma)), 0.0f);
  }
  EXPECT_FALSE(std::isfinite(float_of_24(float24_code(kNoNumber))));
  EXPECT_FALSE(std::isfinite(float_of_16(float16_code(kNoNumber))));
  EXPECT_FALSE(std::isfinite(double_of_48(double48_code(kNoNumber))));
  EXPECT_EQ(direction_of(direction_code({1.1f, 0.0f, 0.0f})).norm(), 0.0f);
  EXPECT_FALSE(covariance_of(covariance_code(Eigen::Matrix3d::Constant(kNoNumber))));
}

TEST(MapQuanta, RoundPatchesToAThirtiethOfTheirContrast) {
  std::mt19937_64 random(6);
  for (const int range : {0, 1, 2, 7, 14, 15, 16, 30, 100, 254}) {
    const Patch patch = random_patch(random, 1, range);
    const PatchCode code = patch_code(patch);
    const std::optional<Patch> rounded = patch_of(code);
    ASSERT_TRUE(rounded.has_value()) << range;
    const double allowed = range <= 15 ? 0.0 : range / 30.0 + 0.5;
    for (std::size_t i = 0; i < patch.pixels.size(); ++i) {
      EXPECT_NEAR(rounded->pixels[i], patch.pixels[i], allowed);
    }
    EXPECT_LT((rounded->centre - patch.centre).norm(), 1e-3f);
    EXPECT_EQ(patch_code(*rounded), code);
  }
}

TEST(MapQuanta, RejectInvalidPatchCodes) {
  std::mt19937_64 random(7);
  const PatchCode sound = patch_code(random_patch(random, 20, 100));
  PatchCode code = sound;
  std::swap(code.darkest, code.brightest);
  EXPECT_FALSE(patch_of(code));
  code = sound;
  code.steps.fill(0x77);  // uses neither the darkest nor the brightest value
  EXPECT_FALSE(patch_of(code));
  code = patch_code(random_patch(random, 20, 1));
  code.steps[3] = 0x01;  // between two adjacent grey values
  EXPECT_FALSE(patch_of(code));
}

}  // namespace
}  // namespace byre
