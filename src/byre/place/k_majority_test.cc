#include "byre/place/k_majority.h"

#include "byre/features/descriptor.h"
#include "byre/place/vocabulary_scene.h"

#include <algorithm>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;
using testing::SizeIs;

constexpr int kRounds = 20;

TEST(Nearest, PrefersTheFirstOfEqualDistances) {
  const std::vector<Descriptor> centres = {{7}, {1}, {2}, {1}};
  EXPECT_EQ(nearest(centres, {3}), 0);
  EXPECT_EQ(nearest(centres, {0}), 1);
  EXPECT_EQ(nearest(centres, {1}), 1);
}

TEST(KMajority, RecoversCentresFromNoisyCopies) {
  const std::vector<Descriptor> truth = random_descriptors(8, 1);
  const std::vector<Descriptor> descriptors = noisy_images(truth, 1, 101, 2, 2).front();
  std::mt19937_64 random(3);
  const Clusters clusters = k_majority(descriptors, 8, kRounds, random);
  EXPECT_THAT(clusters.centres, testing::UnorderedElementsAreArray(truth));
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    EXPECT_EQ(clusters.centres[static_cast<std::size_t>(clusters.cluster_of[i])], truth[i / 101]);
  }
}

TEST(KMajority, AssignsNearestCentresWithoutEmptyClusters) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    const std::vector<Descriptor> descriptors = random_descriptors(60, seed);
    std::mt19937_64 random(seed);
    const Clusters clusters = k_majority(descriptors, 10, 2, random);
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      EXPECT_EQ(clusters.cluster_of[i], nearest(clusters.centres, descriptors[i]));
    }
    const std::set<int> used(clusters.cluster_of.begin(), clusters.cluster_of.end());
    EXPECT_THAT(used, SizeIs(clusters.centres.size()));
  }
}

TEST(KMajority, ReturnsAtMostOneClusterPerDistinctDescriptor) {
  const std::vector<Descriptor> different = random_descriptors(3, 4);
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < 30; ++i) descriptors.push_back(different[static_cast<std::size_t>(i % 3)]);
  std::mt19937_64 random(5);
  EXPECT_THAT(k_majority(descriptors, 10, kRounds, random).centres, testing::UnorderedElementsAreArray(different));
}

TEST(KMajority, AssignsEqualDescriptorsToOneCluster) {
  const std::vector<Descriptor> descriptors(20, random_descriptors(1, 6).front());
  std::mt19937_64 random(7);
  const Clusters clusters = k_majority(descriptors, 10, kRounds, random);
  EXPECT_THAT(clusters.centres, testing::ElementsAre(descriptors.front()));
  EXPECT_THAT(clusters.cluster_of, Each(0));
}

TEST(KMajority, ImprovesOnItsSeeds) {
  const std::vector<Descriptor> descriptors = noisy_images(random_descriptors(30, 8), 1, 20, 40, 9).front();
  const auto total_distance = [&descriptors](int rounds) {
    std::mt19937_64 random(10);
    const Clusters clusters = k_majority(descriptors, 10, rounds, random);
    int sum = 0;
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      sum += hamming_distance(descriptors[i], clusters.centres[static_cast<std::size_t>(clusters.cluster_of[i])]);
    }
    return sum;
  };
  EXPECT_LT(total_distance(1), total_distance(0));
  EXPECT_LE(total_distance(kRounds), total_distance(1));
}

}  // namespace
}  // namespace byre
