#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>

namespace byre {

// The best of neighbouring columns, and the best of those more than one column away from it.
struct LeastCosts {
  int best = 0;                                       // column; the first of equal ones
  int cost = 0;                                       // at its place between the columns
  int second_cost = std::numeric_limits<int>::max();  // where there is one
};

inline constexpr std::size_t kCostsBeyond = 16;  // numbers after the costs that are written over

// costs of columns, each below 0xffff. A minimum's cost counts at its place between the columns; the sum of absolute
// differences grows linearly to both sides of it. On whole columns a repeating pattern would seem unique wherever one
// of its copies happens to fall on a column. Precondition: there is a column; before the first stands a zero, below
// which no minimum lies, and after the last there is room for one, and for kCostsBeyond more.
LeastCosts least_costs(std::uint16_t* costs, std::size_t count);

}  // namespace byre
