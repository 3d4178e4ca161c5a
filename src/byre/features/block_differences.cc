#include "byre/features/block_differences.h"

// The vectorised part of this file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "byre/features/block_differences.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace byre::HWY_NAMESPACE {
namespace {

#if HWY_ARCH_X86 && HWY_TARGET <= HWY_AVX2

__m256i load_lanes(const std::uint8_t* low, const std::uint8_t* high) {
  return _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(high), reinterpret_cast<const __m128i*>(low));
}

// The low lane holds the first eight candidates, the high lane the others. MPSADBW, which Highway does not wrap,
// compares four columns of the block with those of eight neighbouring candidates at once. Its immediate selects the
// four columns, and the start of the candidates in the register.
void sum_differences(const std::uint8_t* block, std::ptrdiff_t block_stride, const std::uint8_t* candidates,
                     std::ptrdiff_t candidates_stride, std::uint16_t* sums_of_candidates) {
  static_assert(kBlockColumns == 16 && kBlockCandidates == 16);
  __m256i sums = _mm256_setzero_si256();
  for (int row = 0; row < kBlockRows; ++row, block += block_stride, candidates += candidates_stride) {
    const __m256i wanted = load_lanes(block, block);
    const __m256i left = load_lanes(candidates, candidates + 8);
    const __m256i right = load_lanes(candidates + 8, candidates + 16);
    sums = _mm256_add_epi16(sums, _mm256_mpsadbw_epu8(left, wanted, 0b000'000));
    sums = _mm256_add_epi16(sums, _mm256_mpsadbw_epu8(left, wanted, 0b101'101));
    sums = _mm256_add_epi16(sums, _mm256_mpsadbw_epu8(right, wanted, 0b010'010));
    sums = _mm256_add_epi16(sums, _mm256_mpsadbw_epu8(right, wanted, 0b111'111));
  }
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(sums_of_candidates), sums);
}

#else

namespace hn = hwy::HWY_NAMESPACE;

// One lane per candidate: one column of the block is compared with all candidates at once.
void sum_differences(const std::uint8_t* block, std::ptrdiff_t block_stride, const std::uint8_t* candidates,
                     std::ptrdiff_t candidates_stride, std::uint16_t* sums_of_candidates) {
  static_assert(kBlockCandidates == 16);
  const hn::FixedTag<std::uint8_t, 16> d8;
  const hn::FixedTag<std::uint16_t, 8> d16;
  const hn::Half<decltype(d8)> half;
  auto first = hn::Zero(d16), others = hn::Zero(d16);
  for (int row = 0; row < kBlockRows; ++row, block += block_stride, candidates += candidates_stride) {
    for (int column = 0; column < kBlockColumns; ++column) {
      const auto wanted = hn::Set(d8, block[column]);
      const auto found = hn::LoadU(d8, candidates + column);
      const auto difference = hn::Sub(hn::Max(wanted, found), hn::Min(wanted, found));
      first = hn::Add(first, hn::PromoteTo(d16, hn::LowerHalf(half, difference)));
      others = hn::Add(others, hn::PromoteTo(d16, hn::UpperHalf(half, difference)));
    }
  }
  hn::StoreU(first, d16, sums_of_candidates);
  hn::StoreU(others, d16, sums_of_candidates + 8);
}

#endif

}  // namespace
}  // namespace byre::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace byre {

HWY_EXPORT(sum_differences);

std::array<std::uint16_t, kBlockCandidates> block_differences(const std::uint8_t* block, std::ptrdiff_t block_stride,
                                                              const std::uint8_t* candidates,
                                                              std::ptrdiff_t candidates_stride) {
  std::array<std::uint16_t, kBlockCandidates> sums;
  HWY_DYNAMIC_DISPATCH(sum_differences)(block, block_stride, candidates, candidates_stride, sums.data());
  return sums;
}

}  // namespace byre

#endif
