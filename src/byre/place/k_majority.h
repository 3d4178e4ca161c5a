#pragma once

#include "byre/features.h"

#include <random>
#include <span>
#include <vector>

namespace byre {

struct Clusters {
  std::vector<Descriptor> centres;  // no cluster is empty
  std::vector<int> cluster_of;      // one per descriptor: index of the nearest centre, the first in ties
};

// Clusters descriptors into at most max_clusters groups by k-majority (Grana 2013): k-means in Hamming space with
// bitwise majority as mean, seeded by k-means++ (Arthur and Vassilvitskii 2007). Gives fewer clusters for fewer
// distinct descriptors. rounds: limit on updates of the centres. Preconditions: descriptors is not empty, max_clusters
// > 0.
Clusters k_majority(std::span<const Descriptor> descriptors, int max_clusters, int rounds, std::mt19937_64& random);

// Index of the centre with the smallest Hamming distance, the first in ties. Precondition: centres is not empty.
int nearest(std::span<const Descriptor> centres, const Descriptor& descriptor);

}  // namespace byre
