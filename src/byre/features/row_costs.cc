#include "byre/features/row_costs.h"

#include <algorithm>
#include <cassert>
#include <cstdlib>

// The vectorised part of this file is compiled once for each instruction set that supports arrays of vectors.
#define HWY_DISABLED_TARGETS (HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128 | HWY_RVV)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/row_costs.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

using D = hn::CappedTag<std::uint16_t, 16>;

HWY_INLINE std::uint16_t min_lane(hn::Vec<D> values) {
  const D d;
  HWY_ALIGN std::uint16_t lanes[16];
  hn::Store(values, d, lanes);
  return *std::min_element(lanes, lanes + hn::Lanes(d));
}

// Index of the least of the first numbers; the numbers after them are not smaller.
std::size_t index_of_min(const std::uint16_t* costs, std::size_t count) {
  const D d;
  auto least = hn::Set(d, 0xffff);
  for (std::size_t i = 0; i < count; i += hn::Lanes(d)) least = hn::Min(least, hn::LoadU(d, costs + i));
  const auto wanted = hn::Set(d, min_lane(least));
  for (std::size_t i = 0;; i += hn::Lanes(d)) {
    const auto found = hn::FindFirstTrue(d, hn::Eq(hn::LoadU(d, costs + i), wanted));
    if (found >= 0) return i + static_cast<std::size_t>(found);
  }
}

// Least interpolated cost over the columns [first, last).
std::uint16_t min_between(const std::uint16_t* costs, std::size_t first, std::size_t last) {
  const D d;
  const auto lanes = static_cast<std::uint16_t>(hn::Lanes(d));
  auto least = hn::Set(d, 0xffff);
  for (std::size_t i = first; i < last; i += lanes) {
    const auto left = hn::LoadU(d, costs + i - 1), here = hn::LoadU(d, costs + i), right = hn::LoadU(d, costs + i + 1);
    const auto lower = hn::Min(left, right);
    const auto between = hn::SaturatedSub(here, hn::ShiftRight<1>(hn::Sub(hn::Max(left, right), lower)));
    const auto cost = hn::IfThenElse(hn::Gt(here, lower), here, between);
    const auto left_over = static_cast<std::uint16_t>(std::min<std::size_t>(last - i, lanes));
    const auto counts = hn::Lt(hn::Iota(d, 0), hn::Set(d, left_over));
    least = hn::IfThenElse(counts, hn::Min(least, cost), least);
  }
  return min_lane(least);
}

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {
namespace {

HWY_EXPORT(index_of_min);
HWY_EXPORT(min_between);

constexpr std::uint16_t kNone = 0xffff;

}  // namespace

MinimumCost find_minimum_cost(std::uint16_t* costs, std::size_t count) {
  assert(count > 0 && costs[-1] == 0);
  costs[count] = kNone;
  std::fill_n(costs + count + 1, kCostPadding, kNone);
  const std::size_t best = HWY_DYNAMIC_DISPATCH(index_of_min)(costs, count);
  costs[count] = 0;
  const int left = costs[best - 1], here = costs[best], right = costs[best + 1];
  MinimumCost least;
  least.best = static_cast<int>(best);
  least.cost = here > std::min(left, right) ? here : std::max(0, here - std::abs(left - right) / 2);
  const std::uint16_t second =
      std::min(best > 1 ? HWY_DYNAMIC_DISPATCH(min_between)(costs, 0, best - 1) : kNone,
               best + 2 < count ? HWY_DYNAMIC_DISPATCH(min_between)(costs, best + 2, count) : kNone);
  if (second != kNone) least.second_cost = second;
  return least;
}

}  // namespace byre

#endif
