#pragma once

#include "byre/features.h"

#include <random>
#include <span>
#include <vector>

namespace byre {

struct Clusters {
  std::vector<Descriptor> centres;  // no cluster is empty
  std::vector<int> cluster_of;      // one per descriptor: the nearest centre, the first of equally near ones
};

// Splits descriptors into at most max_clusters groups by k-majority (Grana 2013): k-means in Hamming space, where the
// mean is the majority of each bit. Starts from k-means++ (Arthur and Vassilvitskii 2007). Fewer clusters when there
// are fewer different descriptors. rounds: how often centres are recomputed at most. Preconditions: descriptors is not
// empty, max_clusters > 0.
Clusters k_majority(std::span<const Descriptor> descriptors, int max_clusters, int rounds, std::mt19937_64& random);

// Index of the centre with the fewest differing bits, the first of equally near ones. Precondition: centres is not
// empty.
int nearest(std::span<const Descriptor> centres, const Descriptor& descriptor);

}  // namespace byre
