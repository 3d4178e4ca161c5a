#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace byre {

// Block of stereo matching: kBlockColumns wide, so that a row is one vector register.
inline constexpr int kBlockColumns = 16;
inline constexpr int kBlockRows = 11;

// Number of candidates compared at once.
inline constexpr int kBlockCandidates = 16;

// Sums of absolute differences between a block and kBlockCandidates blocks at consecutive columns, the first at
// `candidates`. Pointers are to a block's top left pixel. Reads kBlockColumns + kBlockCandidates pixels of each
// candidate row, one more than is compared.
std::array<std::uint16_t, kBlockCandidates> block_differences(const std::uint8_t* block, std::ptrdiff_t block_stride,
                                                              const std::uint8_t* candidates,
                                                              std::ptrdiff_t candidates_stride);

}  // namespace byre
