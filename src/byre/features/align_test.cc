#include "byre/features/align.h"

#include "byre/base/sanitizer_scene.h"
#include "byre/features/detect.h"
#include "byre/features/image_scene.h"
#include "byre/geometry/geometry_matchers.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Eq;

const Eigen::Vector2f kCentre = Eigen::Vector2f::Constant(Patch::kSize / 2);

// Difference of the current view of a corner from the reference view.
struct Change {
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();  // corner relative to the centre of the current patch
  Eigen::Matrix2d reference_from_current = Eigen::Matrix2d::Identity();
  double gain = 1.0;
  double offset = 0.0;  // grey values
  double noise = 0.0;   // grey values, in both views
};

struct TwoViews {
  Patch reference;
  Patch current;
};

TwoViews two_views(const Texture& texture, const Eigen::Vector2d& corner, const Change& change, std::mt19937& random) {
  const auto grey = [&](const Eigen::Vector2d& from_corner) {
    return texture(corner.x() + from_corner.x(), corner.y() + from_corner.y());
  };
  TwoViews views;
  views.reference = render_patch([&](double x, double y) { return grey({x, y}); });
  views.current = render_patch([&](double x, double y) {
    return change.gain * grey(change.reference_from_current * (Eigen::Vector2d(x, y) - change.shift)) + change.offset;
  });
  if (change.noise > 0.0) {
    add_noise(views.reference, change.noise, random);
    add_noise(views.current, change.noise, random);
  }
  return views;
}

std::optional<Alignment> align(const TwoViews& views, const Eigen::Matrix2f& reference_from_current) {
  return align_patches(views.reference, views.reference.centre, views.current, reference_from_current,
                       views.current.centre, {});
}

Eigen::Matrix2d turned_and_scaled(double angle, double scale) {
  return scale * Eigen::Rotation2Dd(angle).toRotationMatrix();
}

// Results of the alignment of many corners.
struct Score {
  int tried = 0;
  std::vector<double> errors;  // octave pixels, per axis, of aligned corners
  std::vector<double> errors_by_sigma;

  void add(const std::optional<Alignment>& aligned, const Eigen::Vector2d& shift) {
    ++tried;
    if (!aligned) return;
    const Eigen::Vector2d error = (aligned->pixel - kCentre).cast<double>() - shift;
    for (const double axis : {error.x(), error.y()}) {
      errors.push_back(std::abs(axis));
      errors_by_sigma.push_back(std::abs(axis) / aligned->sigma);
    }
  }

  double share_aligned() const { return 0.5 * static_cast<double>(errors.size()) / tried; }

  double share_within(double sigmas) const {
    const auto inside =
        std::count_if(errors_by_sigma.begin(), errors_by_sigma.end(), [&](double error) { return error <= sigmas; });
    return static_cast<double>(inside) / static_cast<double>(errors_by_sigma.size());
  }

  // Quantile of the errors.
  double quantile(double share) const {
    std::vector<double> sorted = errors;
    std::sort(sorted.begin(), sorted.end());
    return sorted.at(static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1)));
  }
};

// Aligns all corners of a texture under random changes; shifts are as large as errors of good predictions.
Score align_corners(unsigned seed, const std::function<void(Change&, std::mt19937&)>& draw) {
  const Texture texture(seed, 0.7);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> along(-1.2, 1.2);
  Score score;
  for (const Corner& corner : detect_corners(render(400, 300, texture), 300, {})) {
    Change change;
    change.shift.x() = along(random);
    change.shift.y() = along(random);
    draw(change, random);
    const TwoViews views = two_views(texture, {corner.x, corner.y}, change, random);
    score.add(align(views, change.reference_from_current.cast<float>()), change.shift);
  }
  return score;
}

TEST(AlignPatches, RecoversSubPixelShifts) {
  const Score score = align_corners(1, [](Change&, std::mt19937&) {});
  EXPECT_GE(score.share_aligned(), 0.95);
  EXPECT_LE(score.quantile(0.5), 0.02);
  EXPECT_LE(score.quantile(0.95), 0.05);
}

TEST(AlignPatches, RecoversShiftsUnderRotationAndScale) {
  const Score score = align_corners(2, [](Change& change, std::mt19937& random) {
    std::uniform_real_distribution<double> angle(-0.6, 0.6), octaves(-1.0, 1.0);
    change.reference_from_current = turned_and_scaled(angle(random), std::pow(kOctaveScale, octaves(random)));
  });
  EXPECT_GE(score.share_aligned(), 0.95);
  EXPECT_LE(score.quantile(0.5), 0.02);
  EXPECT_LE(score.quantile(0.95), 0.05);
}

TEST(AlignPatches, CompensatesGainAndOffset) {
  const Score score = align_corners(3, [](Change& change, std::mt19937& random) {
    std::uniform_real_distribution<double> gain(0.5, 1.3);
    change.gain = gain(random);
    change.offset = 128.0 * (1.0 - change.gain) + 10.0;
  });
  EXPECT_GE(score.share_aligned(), 0.95);
  EXPECT_LE(score.quantile(0.5), 0.02);
  EXPECT_LE(score.quantile(0.95), 0.05);
}

// Under strong noise sigma is too small by about half: interpolation blurs the noise from which it is estimated.
TEST(AlignPatches, ErrsWithinItsSigmaUnderNoise) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto with_noise = [](double noise) {
    return align_corners(4, [=](Change& change, std::mt19937&) { change.noise = noise; });
  };
  const Score slight = with_noise(2.0);
  const Score strong = with_noise(6.0);
  EXPECT_GE(slight.share_within(2.0), 0.95);
  EXPECT_LE(slight.quantile(0.5), 0.05);
  EXPECT_GE(strong.share_within(2.0), 0.75);
  EXPECT_LE(strong.quantile(0.5), 0.12);
}

TEST(AlignPatches, EstimatesASmallerSigmaForHigherContrast) {
  const Texture texture(5, 0.7);
  std::mt19937 random(5);
  double sum_clear = 0.0, sum_noisy = 0.0;
  for (const Corner& corner : detect_corners(render(300, 300, texture), 50, {})) {
    Change change;
    change.noise = 1.0;
    const auto clear = align(two_views(texture, {corner.x, corner.y}, change, random), Eigen::Matrix2f::Identity());
    change.noise = 8.0;
    const auto noisy = align(two_views(texture, {corner.x, corner.y}, change, random), Eigen::Matrix2f::Identity());
    if (!clear || !noisy) continue;
    EXPECT_GE(clear->sigma, AlignOptions().min_sigma);
    sum_clear += clear->sigma;
    sum_noisy += noisy->sigma;
  }
  EXPECT_GT(sum_noisy, 1.5 * sum_clear);
}

TEST(AlignPatches, ReturnsFullSimilarityForEqualPatches) {
  std::mt19937 random(6);
  const TwoViews views = two_views(Texture(6), {0.0, 0.0}, {}, random);
  const auto aligned = align(views, Eigen::Matrix2f::Identity());
  ASSERT_TRUE(aligned);
  EXPECT_NEAR(aligned->similarity, 1.0f, 1e-4f);
  EXPECT_THAT(aligned->pixel, PointNear(kCentre, 1e-3));
}

TEST(AlignPatches, RejectsDifferentPatches) {
  const Texture texture(7), other(8);
  std::mt19937 random(7);
  int tried = 0, accepted = 0;
  for (const Corner& corner : detect_corners(render(400, 300, texture), 200, {})) {
    TwoViews views = two_views(texture, {corner.x, corner.y}, {}, random);
    views.current = two_views(other, {corner.x, corner.y}, {}, random).reference;
    ++tried;
    if (align(views, Eigen::Matrix2f::Identity())) ++accepted;
  }
  EXPECT_GT(tried, 150);
  EXPECT_LE(accepted, tried / 8) << "few are similar by chance within the allowed shift";
}

TEST(AlignPatches, RejectsANegative) {
  std::mt19937 random(9);
  Change change;
  change.gain = -1.0;
  change.offset = 255.0;
  EXPECT_THAT(align(two_views(Texture(9), {0.0, 0.0}, change, random), Eigen::Matrix2f::Identity()), Eq(std::nullopt));
}

TEST(AlignPatches, RejectsShiftsBeyondTheLimit) {
  std::mt19937 random(10);
  const TwoViews views = two_views(Texture(10), {0.0, 0.0}, {{1.0, 0.5}}, random);
  AlignOptions options;
  const auto align_within = [&](float max_shift) {
    options.max_shift = max_shift;
    return align_patches(views.reference, kCentre, views.current, Eigen::Matrix2f::Identity(), kCentre, options);
  };
  EXPECT_TRUE(align_within(3.0f));
  EXPECT_FALSE(align_within(0.5f));
}

TEST(AlignPatches, RejectsBlankPatches) {
  const Patch blank = render_patch([](double, double) { return 80.0; });
  const Patch textured = render_patch(Texture(11));
  const Eigen::Matrix2f same = Eigen::Matrix2f::Identity();
  EXPECT_FALSE(align_patches(blank, kCentre, textured, same, kCentre, {}));
  EXPECT_FALSE(align_patches(textured, kCentre, blank, same, kCentre, {}));
  EXPECT_FALSE(align_patches(blank, kCentre, blank, same, kCentre, {}));
}

TEST(AlignPatches, RejectsAnEdgeThatMaySlideAlongItself) {
  const Patch edge = render_patch([](double x, double) { return 128.0 + 100.0 * std::tanh(0.7 * x); });
  EXPECT_FALSE(align_patches(edge, kCentre, edge, Eigen::Matrix2f::Identity(), kCentre, {}));
}

TEST(AlignPatches, RejectsATemplateOutsideItsPatch) {
  std::mt19937 random(12);
  const TwoViews views = two_views(Texture(12), {0.0, 0.0}, {}, random);
  EXPECT_FALSE(align(views, turned_and_scaled(0.0, 2.1).cast<float>())) << "half of 7 pixels, doubled, is 7 and more";
  const auto align_at = [&](const Eigen::Vector2f& reference_pixel, const Eigen::Vector2f& start) {
    return align_patches(views.reference, reference_pixel, views.current, Eigen::Matrix2f::Identity(), start, {});
  };
  EXPECT_TRUE(align_at(kCentre, kCentre));
  EXPECT_FALSE(align_at({3.0f, 8.0f}, kCentre));
  EXPECT_FALSE(align_at({8.0f, 12.0f}, kCentre));
  EXPECT_FALSE(align_at(kCentre, {4.0f, 8.0f}));
  EXPECT_FALSE(align_at(kCentre, {8.0f, 11.0f}));
}

TEST(AlignPatches, RejectsInvalidWarpsAndPixels) {
  std::mt19937 random(13);
  const TwoViews views = two_views(Texture(13), {0.0, 0.0}, {}, random);
  const Eigen::Matrix2f same = Eigen::Matrix2f::Identity();
  for (const float value :
       {1e3f, 1e10f, 1e20f, 1e38f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN()}) {
    for (const float sign : {-1.0f, 1.0f}) {
      for (int axis = 0; axis < 2; ++axis) {
        Eigen::Vector2f far = kCentre;
        far[axis] = sign * value;
        EXPECT_FALSE(align_patches(views.reference, far, views.current, same, kCentre, {})) << far.transpose();
        EXPECT_FALSE(align_patches(views.reference, kCentre, views.current, same, far, {})) << far.transpose();
        for (int column = 0; column < 2; ++column) {
          Eigen::Matrix2f warp = same;
          warp(axis, column) = sign * value;
          EXPECT_FALSE(align(views, warp)) << warp;
        }
      }
    }
  }
}

// Must read only the patches; the address sanitizer detects other reads.
TEST(AlignPatches, StaysInsideThePatchesUnderArbitraryWarps) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  std::mt19937 random(14);
  std::uniform_real_distribution<float> entry(-2.5f, 2.5f), coordinate(-4.0f, 20.0f);
  int aligned_count = 0;
  for (unsigned trial = 0; trial < 3000; ++trial) {
    // Separate heap blocks, so that the sanitizer detects reads beyond them.
    const std::vector<Patch> reference(1, render_patch(Texture(trial)));
    const std::vector<Patch> current(1, render_patch(Texture(trial)));
    Eigen::Matrix2f warp;
    warp << entry(random), entry(random), entry(random), entry(random);
    const Eigen::Vector2f reference_pixel(coordinate(random), coordinate(random));
    const Eigen::Vector2f start(coordinate(random), coordinate(random));
    const Eigen::Matrix2f tame = Eigen::Matrix2f::Identity() + 0.05f * warp;
    for (const Eigen::Matrix2f& tried : {warp, tame}) {
      const auto aligned = align_patches(reference[0], reference_pixel, current[0], tried, start, {});
      if (!aligned) continue;
      ++aligned_count;
      EXPECT_TRUE((aligned->pixel.array() > 0.0f).all() && (aligned->pixel.array() < Patch::kSize).all());
    }
  }
  EXPECT_GT(aligned_count, 0) << "some must pass all bounds";
}

}  // namespace
}  // namespace byre
