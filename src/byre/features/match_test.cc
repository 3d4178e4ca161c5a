#include "byre/features/match.h"

#include "byre/features/descriptor.h"

#include <random>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::IsEmpty;

Features features_of(const std::vector<Descriptor>& descriptors) {
  std::vector<Keypoint> keypoints(descriptors.size());
  for (Keypoint& keypoint : keypoints) keypoint.pixel = {8.0f, 8.0f};  // one cell: keeps the order
  return {64, 64, keypoints, descriptors, {}};
}

// Descriptor with the first `count` bits set.
Descriptor with_bits(int count) {
  Descriptor descriptor{};
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) descriptor[i / 64] |= 1ull << (i % 64);
  return descriptor;
}

std::vector<Descriptor> random_descriptors(std::size_t count, unsigned seed) {
  std::mt19937_64 random(seed);
  std::vector<Descriptor> descriptors(count);
  for (Descriptor& descriptor : descriptors) {
    for (std::uint64_t& word : descriptor) word = random();
  }
  return descriptors;
}

Descriptor with_flipped_bits(Descriptor descriptor, int count, std::mt19937_64& random) {
  const Descriptor before = descriptor;
  while (hamming_distance(before, descriptor) < count) descriptor[random() % 4] ^= 1ull << (random() % 64);
  return descriptor;
}

TEST(MatchFeatures, FindsEachDisturbedDescriptor) {
  const auto first = random_descriptors(60, 1);
  std::vector<Descriptor> second = random_descriptors(20, 2);  // unrelated descriptors
  std::mt19937_64 random(3);
  for (const Descriptor& descriptor : first) second.push_back(with_flipped_bits(descriptor, 30, random));
  const auto matches = match_features(features_of(first), features_of(second), {});
  ASSERT_EQ(matches.size(), first.size());
  for (std::size_t i = 0; i < matches.size(); ++i) {
    EXPECT_EQ(matches[i].first, static_cast<int>(i));
    EXPECT_EQ(matches[i].second, static_cast<int>(i) + 20);
    EXPECT_EQ(matches[i].distance, 30);
  }
}

TEST(MatchFeatures, KeepsMutualBestPairsOnly) {
  // Both features of first are nearest to the only one of second, which is nearest to the latter.
  const auto matches = match_features(features_of({with_bits(0), with_bits(15)}), features_of({with_bits(20)}), {});
  ASSERT_EQ(matches.size(), 1u);
  EXPECT_EQ(matches[0].first, 1);
  EXPECT_EQ(matches[0].distance, 5);
}

TEST(MatchFeatures, RejectsAPairWithASimilarSecondBest) {
  const Features first = features_of({with_bits(0)});
  MatchOptions options;
  options.max_ratio = 0.8f;
  EXPECT_THAT(match_features(first, features_of({with_bits(20), with_bits(24)}), options), IsEmpty());
  EXPECT_EQ(match_features(first, features_of({with_bits(20), with_bits(26)}), options).size(), 1u);
}

TEST(MatchFeatures, RejectsAPairWithAnEqualSecondBest) {
  EXPECT_THAT(match_features(features_of({with_bits(9)}), features_of({with_bits(9), with_bits(9)}), {}), IsEmpty());
}

TEST(MatchFeatures, RejectsAPairWithALargeDistance) {
  MatchOptions options;
  options.max_distance = 60;
  EXPECT_EQ(match_features(features_of({with_bits(0)}), features_of({with_bits(60)}), options).size(), 1u);
  EXPECT_THAT(match_features(features_of({with_bits(0)}), features_of({with_bits(61)}), options), IsEmpty());
}

TEST(MatchFeatures, ReturnsNothingWithoutFeatures) {
  const Features some = features_of(random_descriptors(3, 4));
  EXPECT_THAT(match_features(Features(), some, {}), IsEmpty());
  EXPECT_THAT(match_features(some, Features(), {}), IsEmpty());
}

}  // namespace
}  // namespace byre
