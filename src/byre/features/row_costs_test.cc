#include "byre/features/row_costs.h"

#include <algorithm>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Costs with a zero on either side, and room after them.
std::vector<std::uint16_t> padded_costs(const std::vector<int>& costs) {
  std::vector<std::uint16_t> padded(costs.size() + 2 + kCostPadding, 0);
  for (std::size_t i = 0; i < costs.size(); ++i) padded[i + 1] = static_cast<std::uint16_t>(costs[i]);
  return padded;
}

// Reference implementation without vectors.
MinimumCost reference_minimum(const std::vector<int>& costs) {
  const int count = static_cast<int>(costs.size());
  const auto at = [&](int i) { return i < 0 || i >= count ? 0 : costs[static_cast<std::size_t>(i)]; };
  const auto between = [&](int i) {
    const int left = at(i - 1), here = at(i), right = at(i + 1);
    return here > std::min(left, right) ? here : std::max(0, here - std::abs(left - right) / 2);
  };
  MinimumCost least;
  least.best = static_cast<int>(std::ranges::min_element(costs) - costs.begin());
  least.cost = between(least.best);
  for (int i = 0; i < count; ++i) {
    if (std::abs(i - least.best) > 1) least.second_cost = std::min(least.second_cost, between(i));
  }
  return least;
}

TEST(MinimumCost, MatchTheReference) {
  std::mt19937 random(3);
  for (int count = 1; count < 80; ++count) {
    for (const int largest : {0, 1, 5, 57000}) {
      std::vector<int> costs(static_cast<std::size_t>(count));
      std::ranges::generate(costs, [&] { return std::uniform_int_distribution<int>(0, largest)(random); });
      std::vector<std::uint16_t> padded = padded_costs(costs);
      const MinimumCost found = find_minimum_cost(padded.data() + 1, costs.size()), expected = reference_minimum(costs);
      EXPECT_EQ(found.best, expected.best) << count << " costs up to " << largest;
      EXPECT_EQ(found.cost, expected.cost) << count << " costs up to " << largest;
      EXPECT_EQ(found.second_cost, expected.second_cost) << count << " costs up to " << largest;
    }
  }
}

TEST(MinimumCost, InterpolateMinimaBetweenColumns) {
  std::vector<std::uint16_t> padded = padded_costs({90, 50, 10, 30, 70, 90});
  const MinimumCost found = find_minimum_cost(padded.data() + 1, 6);
  EXPECT_EQ(found.best, 2);
  EXPECT_EQ(found.cost, 0);
  EXPECT_EQ(found.second_cost, 70);
}

}  // namespace
}  // namespace byre
