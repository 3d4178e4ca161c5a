#include "byre/features/match.h"

#include "byre/features/descriptor.h"

#include <limits>

namespace byre {
namespace {

struct Nearest {
  int index = -1;
  int distance = std::numeric_limits<int>::max();
  int second_distance = std::numeric_limits<int>::max();

  void offer(int candidate, int candidate_distance) {
    if (candidate_distance < distance) {
      second_distance = distance;
      distance = candidate_distance;
      index = candidate;
    } else if (candidate_distance < second_distance) {
      second_distance = candidate_distance;
    }
  }
};

}  // namespace

std::vector<Match> match_features(const Features& first, const Features& second, const MatchOptions& options) {
  std::vector<Nearest> nearest_of_second(static_cast<std::size_t>(second.size()));
  std::vector<Nearest> nearest_of_first(static_cast<std::size_t>(first.size()));
  for (int i = 0; i < first.size(); ++i) {
    Nearest& nearest = nearest_of_first[static_cast<std::size_t>(i)];
    for (int j = 0; j < second.size(); ++j) {
      const int distance = hamming_distance(first.descriptor(i), second.descriptor(j));
      nearest.offer(j, distance);
      nearest_of_second[static_cast<std::size_t>(j)].offer(i, distance);
    }
  }
  std::vector<Match> matches;
  for (int i = 0; i < first.size(); ++i) {
    const Nearest& nearest = nearest_of_first[static_cast<std::size_t>(i)];
    if (nearest.index < 0 || nearest.distance > options.max_distance) continue;
    if (static_cast<float>(nearest.distance) >= options.max_ratio * static_cast<float>(nearest.second_distance))
      continue;
    if (nearest_of_second[static_cast<std::size_t>(nearest.index)].index != i) continue;
    matches.push_back({i, nearest.index, nearest.distance});
  }
  return matches;
}

}  // namespace byre
