// Patches are made from a smooth texture on a plane, seen by two cameras.

#include "byre/slam/tracking/measurement.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr double kDepth = 3.0;  // metres from the reference camera to the plane, which faces it

// Grey value at a position on a surface, metres; sum of waves in twelve directions.
class Texture {
 public:
  explicit Texture(std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> angle(0.0, 2.0 * std::numbers::pi);
    std::uniform_real_distribution<double> wave_length(0.05, 0.12);
    for (Wave& wave : waves_) {
      const double direction = angle(random);
      const double frequency = 2.0 * std::numbers::pi / wave_length(random);
      wave = {frequency * std::cos(direction), frequency * std::sin(direction), angle(random)};
    }
  }

  double grey(double x, double y) const {
    double sum = 0.0;
    for (const Wave& wave : waves_) sum += std::sin(wave.x * x + wave.y * y + wave.phase);
    return 128.0 + 15.0 * sum;
  }

 private:
  struct Wave {
    double x = 0.0, y = 0.0, phase = 0.0;
  };
  std::array<Wave, 12> waves_;
};

// View of a textured plane z = kDepth in the world.
struct Painting {
  const Texture& texture;
  double noise_sigma = 0.0;  // grey values
  std::uint64_t noise_seed = 1;
};

Patch take_patch(const Painting& painting, const Rig& rig, const Pose& camera_from_world, const Keypoint& keypoint) {
  std::mt19937_64 random(painting.noise_seed);
  std::normal_distribution<double> noise(0.0, std::max(1e-9, painting.noise_sigma));
  const Pose world_from_camera = inverse(camera_from_world);
  Patch patch;
  patch.centre = {8.0f, 8.0f};
  for (int row = 0; row < Patch::kSize; ++row) {
    for (int column = 0; column < Patch::kSize; ++column) {
      const Eigen::Vector2f offset = Eigen::Vector2f(column, row) - patch.centre;
      const Eigen::Vector2f pixel = keypoint.pixel + kScaleOfOctave[keypoint.octave] * offset;
      const Eigen::Vector3d ray = world_from_camera.rotation * rig.ray(pixel.cast<double>());
      const double reach = (kDepth - world_from_camera.translation.z()) / ray.z();
      const Eigen::Vector3d hit = world_from_camera.translation + reach * ray;
      const double grey = painting.texture.grey(hit.x(), hit.y()) + noise(random);
      patch.pixels[static_cast<std::size_t>(row * Patch::kSize + column)] =
          static_cast<std::uint8_t>(std::clamp(std::lround(grey), 0L, 255L));
    }
  }
  return patch;
}

Features one_feature(const Keypoint& keypoint, const std::vector<Patch>& patches) {
  return Features(752, 480, {keypoint}, {Descriptor{}}, patches);
}

Keypoint keypoint_at(const Eigen::Vector2d& pixel, std::uint8_t octave) {
  Keypoint keypoint;
  keypoint.pixel = pixel.cast<float>();
  keypoint.octave = octave;
  return keypoint;
}

// Two views of one point; the second view's corner is off by corner_error.
struct Pair {
  Pose camera_from_reference;
  std::uint8_t reference_octave = 1;
  std::uint8_t octave = 1;
  Eigen::Vector2d corner_error{0.9, -0.7};  // octave pixels
};

const Eigen::Vector3d kPoint(0.3, -0.2, kDepth);  // the reference camera is the world

StereoPixel true_pixel(const Pair& pair) {
  return simulated_rig().project(pair.camera_from_reference * kPoint);
}

PixelMeasurement measure_pair(const Pair& pair, const Painting& reference_painting, const Painting& painting) {
  const Rig rig = simulated_rig();
  const Keypoint reference_keypoint = keypoint_at(rig.project(kPoint).head<2>(), pair.reference_octave);
  const double scale = kScaleOfOctave[pair.octave];
  const Keypoint keypoint = keypoint_at(true_pixel(pair).head<2>() + scale * pair.corner_error, pair.octave);
  const Features reference_features =
      one_feature(reference_keypoint, {take_patch(reference_painting, rig, Pose{}, reference_keypoint)});
  const Features features = one_feature(keypoint, {take_patch(painting, rig, pair.camera_from_reference, keypoint)});
  const CameraView reference{reference_features, rig, Pose{}};
  const CameraView current{features, rig, pair.camera_from_reference};
  return measure_pixel({reference, 0, reference_keypoint.pixel}, kPoint, current, 0);
}

const Texture kTexture(7);

struct NamedPair {
  const char* name;
  Pair pair;
};

class MeasurePixel : public ::testing::TestWithParam<NamedPair> {};

TEST_P(MeasurePixel, MatchesTheReferencePatch) {
  const PixelMeasurement measured = measure_pair(GetParam().pair, {kTexture}, {kTexture});
  EXPECT_TRUE(measured.aligned);
  EXPECT_THAT(measured.pixel.cast<double>(), PointNear(true_pixel(GetParam().pair).head<2>(), 0.1));
}

TEST_P(MeasurePixel, IsMoreCertainThanTheCorner) {
  const Pair& pair = GetParam().pair;
  const PixelMeasurement measured = measure_pair(pair, {kTexture}, {kTexture});
  EXPECT_LT(measured.sigma, 0.5f * corner_measurement(keypoint_at({100.0, 100.0}, pair.octave)).sigma);
}

TEST_P(MeasurePixel, ErrsWithinItsSigmaOnNoisyImages) {
  double squared_sigmas = 0.0;
  constexpr int kTrials = 200;
  for (std::uint64_t trial = 0; trial < kTrials; ++trial) {
    const Texture texture(100 + trial);
    const PixelMeasurement measured =
        measure_pair(GetParam().pair, {texture, 4.0, 2 * trial}, {texture, 4.0, 2 * trial + 1});
    const Eigen::Vector2d error = measured.pixel.cast<double>() - true_pixel(GetParam().pair).head<2>();
    squared_sigmas += error.squaredNorm() / (2.0 * measured.sigma * measured.sigma * kTrials);
  }
  EXPECT_LT(squared_sigmas, 1.5);
}

INSTANTIATE_TEST_SUITE_P(
    From, MeasurePixel,
    ::testing::Values(NamedPair{"TheSide", {{Eigen::Quaterniond::Identity(), {0.3, 0.1, 0.0}}}},
                      NamedPair{"NearerInAHigherOctave", {{Eigen::Quaterniond::Identity(), {0.0, 0.0, -0.5}}, 1, 2}},
                      NamedPair{"FartherInALowerOctave", {{Eigen::Quaterniond::Identity(), {0.0, 0.0, 0.6}}, 2, 1}},
                      NamedPair{"ARolledCamera", {{rotation_exp({0.0, 0.0, 0.35}), {0.1, 0.0, 0.0}}}},
                      NamedPair{"ATurnedCamera", {{rotation_exp({0.0, 0.25, 0.0}), {-0.4, 0.0, 0.1}}}}),
    [](const auto& tested) { return tested.param.name; });

// Expects the fallback without usable patches.
void expect_corner(const PixelMeasurement& measured, const Keypoint& keypoint) {
  EXPECT_FALSE(measured.aligned);
  EXPECT_EQ(measured.pixel, keypoint.pixel);
  EXPECT_EQ(measured.sigma, corner_measurement(keypoint).sigma);
}

Keypoint corner_of(const Pair& pair) {
  const double scale = kScaleOfOctave[pair.octave];
  return keypoint_at(true_pixel(pair).head<2>() + scale * pair.corner_error, pair.octave);
}

const Pair kFromTheSide{{Eigen::Quaterniond::Identity(), {0.3, 0.1, 0.0}}};

TEST(MeasurePixel, IsTheCornerForDifferentPatches) {
  expect_corner(measure_pair(kFromTheSide, {kTexture}, {Texture(8)}), corner_of(kFromTheSide));
}

TEST(MeasurePixel, IsTheCornerForALargeChangeOfScale) {
  const Pair much_nearer{{Eigen::Quaterniond::Identity(), {0.0, 0.0, -2.0}}};
  expect_corner(measure_pair(much_nearer, {kTexture}, {kTexture}), corner_of(much_nearer));
}

TEST(MeasurePixel, IsTheCornerWithoutPatches) {
  const Rig rig = simulated_rig();
  const Keypoint reference_keypoint = keypoint_at(rig.project(kPoint).head<2>(), 1);
  const Keypoint keypoint = corner_of(kFromTheSide);
  const Features with_patch =
      one_feature(reference_keypoint, {take_patch({kTexture}, rig, Pose{}, reference_keypoint)});
  const Features without_patch = one_feature(keypoint, {});
  const CameraView reference{with_patch, rig, Pose{}};
  const CameraView current{without_patch, rig, kFromTheSide.camera_from_reference};
  expect_corner(measure_pixel({reference, 0, reference_keypoint.pixel}, kPoint, current, 0), keypoint);
}

TEST(MeasurePixel, AcceptsAReferencePixelBesideItsCorner) {
  const Rig rig = simulated_rig();
  const Keypoint corner = keypoint_at(rig.project(kPoint).head<2>() + Eigen::Vector2d(1.0, 0.8), 1);
  const Keypoint keypoint = corner_of(kFromTheSide);
  const Features reference_features = one_feature(corner, {take_patch({kTexture}, rig, Pose{}, corner)});
  const Features features =
      one_feature(keypoint, {take_patch({kTexture}, rig, kFromTheSide.camera_from_reference, keypoint)});
  const CameraView reference{reference_features, rig, Pose{}};
  const CameraView current{features, rig, kFromTheSide.camera_from_reference};
  const Eigen::Vector2f reference_pixel = rig.project(kPoint).head<2>().cast<float>();
  const PixelMeasurement measured = measure_pixel({reference, 0, reference_pixel}, kPoint, current, 0);
  EXPECT_TRUE(measured.aligned);
  EXPECT_THAT(measured.pixel.cast<double>(), PointNear(true_pixel(kFromTheSide).head<2>(), 0.1));
}

TEST(CornerMeasurement, IsLessCertainInHigherOctaves) {
  for (std::uint8_t octave = 1; octave < kOctaves; ++octave) {
    const float ratio = corner_measurement(keypoint_at({9.0, 9.0}, octave)).sigma /
                        corner_measurement(keypoint_at({9.0, 9.0}, octave - 1)).sigma;
    EXPECT_NEAR(ratio, kOctaveScale, 1e-5);
  }
}

}  // namespace
}  // namespace byre
