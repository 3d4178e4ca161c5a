#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace byre {

// The blocks that stereo matching compares: kBlockColumns wide, so that a row is one vector register.
inline constexpr int kBlockColumns = 16;
inline constexpr int kBlockRows = 11;

// Candidates that are compared at once.
inline constexpr int kBlockCandidates = 16;

// Sums of absolute differences between a block and those that begin at kBlockCandidates columns in a row, the first at
// `candidates`. Pointers are to a block's top left pixel. Of each row of candidates kBlockColumns + kBlockCandidates
// pixels are read, one more than is compared.
std::array<std::uint16_t, kBlockCandidates> block_differences(const std::uint8_t* block, std::ptrdiff_t block_stride,
                                                              const std::uint8_t* candidates,
                                                              std::ptrdiff_t candidates_stride);

}  // namespace byre
