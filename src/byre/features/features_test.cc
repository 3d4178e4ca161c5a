#include "byre/features.h"

#include <algorithm>
#include <limits>
#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

constexpr int kOddWidth = 333;  // not a multiple of the cells' size
constexpr int kOddHeight = 215;

std::vector<Keypoint> random_keypoints(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> u(0.0f, kOddWidth - 1.0f), v(0.0f, kOddHeight - 1.0f);
  std::uniform_int_distribution<int> octave(0, kOctaves - 1);
  std::vector<Keypoint> keypoints(static_cast<std::size_t>(count));
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    keypoints[i].pixel = {u(random), v(random)};
    keypoints[i].octave = static_cast<std::uint8_t>(octave(random));
    keypoints[i].response = static_cast<float>(i);  // identifies the keypoint
  }
  return keypoints;
}

// Descriptor and patch identify their keypoint.
Features make_features(const std::vector<Keypoint>& keypoints) {
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;
  for (const Keypoint& keypoint : keypoints) {
    descriptors.push_back({static_cast<std::uint64_t>(keypoint.response), 0, 0, 0});
    patches.emplace_back().centre.x() = keypoint.response;
  }
  return {kOddWidth, kOddHeight, keypoints, descriptors, patches};
}

std::vector<int> visited(const Features& features, const Eigen::Vector2f& pixel, float radius, int min_octave,
                         int max_octave) {
  std::vector<int> indices;
  features.visit_area(pixel, radius, min_octave, max_octave, [&](int i) { indices.push_back(i); });
  return indices;
}

std::vector<int> brute_force_search(const Features& features, const Eigen::Vector2f& pixel, float radius,
                                    int min_octave, int max_octave) {
  std::vector<int> indices;
  for (int i = 0; i < features.size(); ++i) {
    const Keypoint& keypoint = features.keypoint(i);
    const bool near = (keypoint.pixel - pixel).cwiseAbs().maxCoeff() <= radius;
    if (near && keypoint.octave >= min_octave && keypoint.octave <= max_octave) indices.push_back(i);
  }
  return indices;
}

TEST(FeaturesVisitArea, EqualsExhaustiveSearch) {
  const Features features = make_features(random_keypoints(600, 1));
  std::mt19937 random(2);
  std::uniform_real_distribution<float> u(-60.0f, kOddWidth + 60.0f), v(-60.0f, kOddHeight + 60.0f), size(0.0f, 70.0f);
  std::uniform_int_distribution<int> octave(0, kOctaves - 1);
  std::size_t found = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::Vector2f pixel(u(random), v(random));
    const float radius = size(random);
    const auto [low, high] = std::minmax({octave(random), octave(random)});
    const std::vector<int> expected = brute_force_search(features, pixel, radius, low, high);
    EXPECT_THAT(visited(features, pixel, radius, low, high), UnorderedElementsAreArray(expected));
    found += expected.size();
  }
  EXPECT_GT(found, 5000u) << "the areas must contain features";
}

TEST(FeaturesVisitArea, ReachesKeypointsOnTheLastRowAndColumn) {
  Keypoint corner;
  corner.pixel = {kOddWidth - 1.0f, kOddHeight - 1.0f};
  EXPECT_THAT(visited(make_features({corner}), corner.pixel, 0.0f, 0, 0), ElementsAre(0));
}

TEST(FeaturesVisitArea, VisitsNothingWithoutFeatures) {
  EXPECT_THAT(visited(Features(), {10.0f, 10.0f}, 100.0f, 0, kOctaves - 1), IsEmpty());
  EXPECT_THAT(visited(make_features({}), {10.0f, 10.0f}, 100.0f, 0, kOctaves - 1), IsEmpty());
}

TEST(FeaturesVisitArea, VisitsNothingFarOutsideTheImage) {
  const Features features = make_features(random_keypoints(200, 3));
  EXPECT_THAT(visited(features, {1e20f, -1e20f}, 50.0f, 0, kOctaves - 1), IsEmpty());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(visited(features, {-500.0f, nan}, 50.0f, 0, kOctaves - 1), IsEmpty());
}

TEST(Features, KeepDescriptorAndPatchWithTheKeypoint) {
  const Features features = make_features(random_keypoints(300, 4));
  ASSERT_EQ(features.size(), 300);
  std::vector<float> names;
  for (int i = 0; i < features.size(); ++i) {
    names.push_back(features.keypoint(i).response);
    EXPECT_EQ(static_cast<float>(features.descriptor(i)[0]), names.back());
    EXPECT_EQ(features.find_patch(i)->centre.x(), names.back());
  }
  std::sort(names.begin(), names.end());
  EXPECT_TRUE(std::adjacent_find(names.begin(), names.end()) == names.end()) << "each is present once";
}

TEST(Features, KeepTheGivenOrderWithinACell) {
  std::vector<Keypoint> keypoints(3);
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    keypoints[i].pixel = {40.0f - static_cast<float>(i), 20.0f};  // from right to left, one cell
    keypoints[i].response = static_cast<float>(i);
  }
  const Features features = make_features(keypoints);
  EXPECT_THAT(features.descriptors(), ElementsAre(Descriptor{0}, Descriptor{1}, Descriptor{2}));
}

TEST(Features, AreUnchangedWhenSortedAgain) {
  const Features once = make_features(random_keypoints(300, 5));
  const Features twice(kOddWidth, kOddHeight, to_vector(once.keypoints()), to_vector(once.descriptors()), {});
  EXPECT_TRUE(std::ranges::equal(once.descriptors(), twice.descriptors()));
}

TEST(Features, MayHaveNoPatches) {
  const Features features(kOddWidth, kOddHeight, random_keypoints(5, 6), std::vector<Descriptor>(5), {});
  EXPECT_EQ(features.size(), 5);
  EXPECT_EQ(features.find_patch(0), nullptr);
}

TEST(Features, KeepSomePatchesOnly) {
  const std::vector<Keypoint> keypoints = random_keypoints(3, 7);
  std::vector<Patch> patches(1);
  patches[0].centre.x() = keypoints[1].response;
  const Features features(kOddWidth, kOddHeight, keypoints, std::vector<Descriptor>(3), patches, {-1, 0, -1});
  for (int i = 0; i < features.size(); ++i) {
    const bool kept = features.keypoint(i).response == keypoints[1].response;
    ASSERT_EQ(features.find_patch(i) != nullptr, kept);
    if (kept) {
      EXPECT_EQ(features.find_patch(i)->centre.x(), keypoints[1].response);
    }
  }
}

TEST(Features, KeepTheRequestedPatchesAndAllElse) {
  const Features all = make_features(random_keypoints(6, 8));
  const std::vector<int> kept = {1, 4};
  const Features some = all.with_patches_of(kept);
  ASSERT_EQ(some.size(), all.size());
  for (int i = 0; i < all.size(); ++i) {
    EXPECT_EQ(some.keypoint(i).pixel, all.keypoint(i).pixel);
    EXPECT_EQ(some.descriptor(i), all.descriptor(i));
    ASSERT_EQ(some.find_patch(i) != nullptr, i == 1 || i == 4);
    if (some.find_patch(i)) {
      EXPECT_EQ(some.find_patch(i)->centre, all.find_patch(i)->centre);
    }
  }
  const std::vector<int> fewer = {0, 4};
  EXPECT_EQ(some.with_patches_of(fewer).find_patch(0), nullptr) << "it was not kept";
  EXPECT_NE(some.with_patches_of(fewer).find_patch(4), nullptr);
}

TEST(Features, AreFoundInALargeSparseImage) {
  Keypoint keypoint;
  keypoint.pixel = {15000.0f, 9000.0f};
  const Features features(16000, 16000, {keypoint}, {{}}, {});
  EXPECT_THAT(visited(features, {15003.0f, 9000.0f}, 5.0f, 0, 0), ElementsAre(0));
  EXPECT_THAT(visited(features, {14000.0f, 9000.0f}, 5.0f, 0, 0), IsEmpty());
}

}  // namespace
}  // namespace byre
