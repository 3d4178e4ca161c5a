// Helpers of the vectorised loops. Included once for each instruction set, so it has no usual include guard.
#if defined(BYRE_FEATURES_PAIRWISE_SUMS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef BYRE_FEATURES_PAIRWISE_SUMS_INL_H_
#undef BYRE_FEATURES_PAIRWISE_SUMS_INL_H_
#else
#define BYRE_FEATURES_PAIRWISE_SUMS_INL_H_
#endif

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Lane i of the sums: a[2i] * b[2i] + a[2i+1] * b[2i+1], of 16-bit lanes.
template <class D32, class V16>
HWY_INLINE hn::Vec<D32> pairwise_sums(D32 d32, V16 a, V16 b) {
  hn::Vec<D32> odd = hn::Zero(d32);
  const hn::Vec<D32> even = hn::ReorderWidenMulAccumulate(d32, a, b, hn::Zero(d32), odd);
  return hn::RearrangeToOddPlusEven(even, odd);
}

// Vector with all pairs of 16-bit lanes set to (low, high).
template <class D16>
HWY_INLINE hn::Vec<D16> repeated_pair(D16 d16, int low, int high) {
  const hn::RepartitionToWide<D16> d32;
  return hn::BitCast(d16, hn::Set(d32, static_cast<std::int32_t>((static_cast<std::uint32_t>(high) << 16U) |
                                                                 (static_cast<std::uint32_t>(low) & 0xffffU))));
}

}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
