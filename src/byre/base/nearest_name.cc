#include "byre/base/nearest_name.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace byre {
namespace {

// Optimal string alignment distance: Levenshtein distance with swaps of neighbours.
std::size_t distance_between(std::string_view one, std::string_view other) {
  std::vector<std::size_t> before;  // rows of the table for shorter parts of `one`
  std::vector<std::size_t> last;
  std::vector<std::size_t> row(other.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= one.size(); ++i) {
    before = std::exchange(last, row);
    row[0] = i;
    for (std::size_t j = 1; j <= other.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (one[i - 1] == other[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool is_swapped = i > 1 && j > 1 && one[i - 1] == other[j - 2] && one[i - 2] == other[j - 1];
      if (is_swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
  }
  return row.back();
}

}  // namespace

std::optional<std::string> nearest_name(std::string_view given, const std::vector<std::string>& names) {
  constexpr std::size_t kLettersPerMistake = 5;  // longer names may have more mistakes
  constexpr std::size_t kShortestPart = 3;       // letters of a name that suffice
  std::optional<std::string> nearest;
  std::pair<bool, std::size_t> least;  // names that contain the given one come first, then those with fewest mistakes
  for (const std::string& name : names) {
    const std::size_t mistakes = distance_between(given, name);
    const bool is_part = given.size() >= kShortestPart && name.find(given) != std::string::npos;
    const bool is_close = is_part || mistakes <= 1 + given.size() / kLettersPerMistake;
    const std::pair rank{!is_part, mistakes};
    if (!is_close || (nearest && rank >= least)) continue;
    nearest = name;
    least = rank;
  }
  return nearest;
}

}  // namespace byre
