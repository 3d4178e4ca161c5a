#include "byre/place/k_majority.h"

#include "byre/features/descriptor.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <utility>

namespace byre {
namespace {

constexpr int kWordBits = 64;  // bits per element of a descriptor

// Per bit the number of descriptors of a cluster in which it is set.
class BitCounts {
 public:
  void add(const Descriptor& descriptor) {
    ++descriptors_;
    for (std::size_t i = 0; i < descriptor.size(); ++i) {
      for (std::size_t bit = 0; bit < kWordBits; ++bit) {
        counts_[i * kWordBits + bit] += static_cast<std::uint32_t>(descriptor[i] >> bit) & 1u;
      }
    }
  }

  // Ties keep the bit of `before`.
  Descriptor majority(const Descriptor& before) const {
    Descriptor result{};
    for (std::size_t i = 0; i < result.size(); ++i) {
      for (std::size_t bit = 0; bit < kWordBits; ++bit) {
        const std::uint64_t twice = 2 * std::uint64_t{counts_[i * kWordBits + bit]};
        const bool set = twice == descriptors_ ? (before[i] >> bit & 1u) != 0 : twice > descriptors_;
        result[i] |= std::uint64_t{set} << bit;
      }
    }
    return result;
  }

 private:
  std::array<std::uint32_t, 4 * kWordBits> counts_{};
  std::uint64_t descriptors_ = 0;
};

// An index drawn with probability proportional to its weight. std::discrete_distribution is not portable between
// libraries. Precondition: total is the sum of the weights and not zero.
std::size_t draw(std::span<const std::uint32_t> weights, std::uint64_t total, std::mt19937_64& random) {
  std::uint64_t left = random() % total;
  std::size_t index = 0;
  while (left >= weights[index]) left -= weights[index++];
  return index;
}

// k-means++: draws each further centre with probability proportional to the squared distance to the nearest centre.
std::vector<Descriptor> seed_centres(std::span<const Descriptor> descriptors, int count, std::mt19937_64& random) {
  std::vector<Descriptor> centres = {descriptors[random() % descriptors.size()]};
  std::vector<std::uint32_t> squared_distance(descriptors.size(), std::numeric_limits<std::uint32_t>::max());
  while (static_cast<int>(centres.size()) < count) {
    std::uint64_t total = 0;
    for (std::size_t i = 0; i < descriptors.size(); ++i) {
      const auto distance = static_cast<std::uint32_t>(hamming_distance(descriptors[i], centres.back()));
      squared_distance[i] = std::min(squared_distance[i], distance * distance);
      total += squared_distance[i];
    }
    if (total == 0) break;  // every distinct descriptor is a centre
    centres.push_back(descriptors[draw(squared_distance, total, random)]);
  }
  return centres;
}

// Assigns each descriptor to its nearest centre; false if nothing changes.
bool assign(std::span<const Descriptor> descriptors, Clusters& clusters) {
  bool changed = false;
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    const int cluster = nearest(clusters.centres, descriptors[i]);
    changed |= cluster != clusters.cluster_of[i];
    clusters.cluster_of[i] = cluster;
  }
  return changed;
}

void move_centres(std::span<const Descriptor> descriptors, Clusters& clusters) {
  std::vector<BitCounts> counts(clusters.centres.size());
  for (std::size_t i = 0; i < descriptors.size(); ++i) {
    counts[static_cast<std::size_t>(clusters.cluster_of[i])].add(descriptors[i]);
  }
  for (std::size_t c = 0; c < counts.size(); ++c) clusters.centres[c] = counts[c].majority(clusters.centres[c]);
}

void drop_empty(Clusters& clusters) {
  std::vector<int> members(clusters.centres.size(), 0);
  for (const int cluster : clusters.cluster_of) ++members[static_cast<std::size_t>(cluster)];
  std::vector<int> new_number(members.size(), -1);
  std::vector<Descriptor> kept;
  for (std::size_t c = 0; c < members.size(); ++c) {
    if (members[c] == 0) continue;
    new_number[c] = static_cast<int>(kept.size());
    kept.push_back(clusters.centres[c]);
  }
  for (int& cluster : clusters.cluster_of) cluster = new_number[static_cast<std::size_t>(cluster)];
  clusters.centres = std::move(kept);
}

}  // namespace

int nearest(std::span<const Descriptor> centres, const Descriptor& descriptor) {
  int best = 0;
  int best_distance = std::numeric_limits<int>::max();
  for (std::size_t i = 0; i < centres.size(); ++i) {
    const int distance = hamming_distance(centres[i], descriptor);
    if (distance >= best_distance) continue;
    best = static_cast<int>(i);
    best_distance = distance;
  }
  return best;
}

Clusters k_majority(std::span<const Descriptor> descriptors, int max_clusters, int rounds, std::mt19937_64& random) {
  Clusters clusters{seed_centres(descriptors, max_clusters, random), std::vector<int>(descriptors.size(), -1)};
  assign(descriptors, clusters);
  for (int round = 0; round < rounds; ++round) {
    move_centres(descriptors, clusters);
    if (!assign(descriptors, clusters)) break;
  }
  drop_empty(clusters);
  return clusters;
}

}  // namespace byre
