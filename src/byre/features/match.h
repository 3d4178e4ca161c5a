#pragma once

#include "byre/features.h"

#include <vector>

namespace byre {

struct Match {
  int first = 0;  // feature index
  int second = 0;
  int distance = 0;  // Hamming bits
};

struct MatchOptions {
  int max_distance = 60;   // bits
  float max_ratio = 0.8f;  // best over second best
};

// Compares each feature of first with each of second; yields mutual best matches only. Ordered by first.
std::vector<Match> match_features(const Features& first, const Features& second, const MatchOptions& options);

}  // namespace byre
