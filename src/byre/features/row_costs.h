#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace byre {

// The best of neighbouring columns, and the best of those more than one column away from it.
struct MinimumCost {
  int best = 0;                                       // column; the first of equal ones
  int cost = 0;                                       // interpolated to the minimum between columns
  int second_cost = std::numeric_limits<int>::max();  // the maximum if there is none
};

inline constexpr std::size_t kCostPadding = 16;  // numbers after the costs that are overwritten

// costs: one per column, each below 0xffff. Minima are interpolated between columns, because the sum of absolute
// differences grows linearly on both sides. On whole columns a repetitive pattern would seem unique if one copy happens
// to fall on a column. Preconditions: at least one column; a zero before the first cost, below which no minimum lies;
// room after the last for one value and kCostPadding more.
MinimumCost find_minimum_cost(std::uint16_t* costs, std::size_t count);

}  // namespace byre
