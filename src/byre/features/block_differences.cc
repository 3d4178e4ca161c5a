#include "byre/features/block_differences.h"

#include <cstdlib>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace byre {

#ifdef __AVX2__

namespace {

__m256i load_lanes(const std::uint8_t* low, const std::uint8_t* high) {
  return _mm256_loadu2_m128i(reinterpret_cast<const __m128i*>(high), reinterpret_cast<const __m128i*>(low));
}

}  // namespace

// The low lane holds the first eight candidates, the high lane the others. MPSADBW compares four columns of the block
// with those of eight neighbouring candidates at once; its immediate says which four, and where in the register the
// candidates' own begin.
std::array<std::uint16_t, kBlockCandidates> block_differences(const std::uint8_t* block, std::ptrdiff_t block_stride,
                                                              const std::uint8_t* candidates,
                                                              std::ptrdiff_t candidates_stride) {
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
  std::array<std::uint16_t, kBlockCandidates> result;
  _mm256_storeu_si256(reinterpret_cast<__m256i*>(result.data()), sums);
  return result;
}

#else

std::array<std::uint16_t, kBlockCandidates> block_differences(const std::uint8_t* block, std::ptrdiff_t block_stride,
                                                              const std::uint8_t* candidates,
                                                              std::ptrdiff_t candidates_stride) {
  std::array<std::uint16_t, kBlockCandidates> result{};
  for (int row = 0; row < kBlockRows; ++row, block += block_stride, candidates += candidates_stride) {
    for (int i = 0; i < kBlockCandidates; ++i) {
      int sum = 0;
      for (int column = 0; column < kBlockColumns; ++column) {
        sum += std::abs(int(block[column]) - int(candidates[i + column]));
      }
      result[static_cast<std::size_t>(i)] = static_cast<std::uint16_t>(result[static_cast<std::size_t>(i)] + sum);
    }
  }
  return result;
}

#endif

}  // namespace byre
