#pragma once

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>
#include <vector>

namespace byre {

// The middle value, of an even number the upper of the two; there must be one. Reorders them.
template <typename Value>
Value median_of(std::span<Value> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The middle value, of an even number the upper of the two; there must be one.
template <typename Value>
Value median(std::vector<Value> values) {
  return median_of(std::span(values));
}

template <typename Value>
Value median_or(std::vector<Value> values, Value of_none) {
  return values.empty() ? of_none : median(std::move(values));
}

// The standard deviation of most of these if they are normal, from how far each is off, in its own sigmas. Never less
// than one, and one where there is none.
inline double robust_scale(std::vector<double> deviations) {
  constexpr double kSigmasOfMedian = 1.4826;  // standard deviation over the median of absolute deviations
  return deviations.empty() ? 1.0 : std::max(1.0, kSigmasOfMedian * median(std::move(deviations)));
}

}  // namespace byre
