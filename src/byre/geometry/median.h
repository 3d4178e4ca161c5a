#pragma once

#include <algorithm>
#include <cassert>
#include <span>
#include <utility>
#include <vector>

namespace byre {

// The median; for an even count the upper of the two middle values. Reorders the values. Precondition: not empty.
template <typename Value>
Value median_of(std::span<Value> values) {
  assert(!values.empty());
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::ranges::nth_element(values, middle);
  return *middle;
}

// The median; for an even count the upper of the two middle values. Precondition: not empty.
template <typename Value>
Value median(std::vector<Value> values) {
  return median_of(std::span(values));
}

// The value at a share of the ascending values, 0 to 1. Precondition: not empty.
template <typename Value>
Value quantile(std::vector<Value> values, double share) {
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::ranges::nth_element(values, place);
  return *place;
}

template <typename Value>
Value median_or(std::vector<Value> values, Value of_none) {
  return values.empty() ? of_none : median(std::move(values));
}

inline constexpr double kSigmasOfMedian = 1.4826;  // standard deviation over median absolute deviation, if normal

// Robust standard deviation from absolute deviations in sigmas, by their median. At least 1, and 1 without deviations.
inline double robust_scale(std::vector<double> deviations) {
  return deviations.empty() ? 1.0 : std::max(1.0, kSigmasOfMedian * median(std::move(deviations)));
}

}  // namespace byre
