#pragma once

#include "byre/map/map_quanta.h"
#include "byre/map/map_sections.h"

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

namespace byre {

// Layout of keyframes' features and sightings: see docs/reference/map_format.md.

// First byte of a keypoint; its lowest bits are the octave.
inline constexpr std::uint8_t kOctaveBits = 7;
inline constexpr std::uint8_t kHasDisparity = 8;
inline constexpr std::uint8_t kHasPatch = 16;
inline constexpr std::uint8_t kSeesPoint = 32;
inline constexpr std::uint8_t kNoOctave = 64;  // invalid in any map
inline constexpr std::uint8_t kAllBits = kOctaveBits | kHasDisparity | kHasPatch | kSeesPoint;

inline constexpr std::size_t kLeastKeypointBytes = 1 + 2;
inline constexpr std::size_t kDisparityBytes = 3;
inline constexpr std::size_t kPatchHeadBytes = 2 + sizeof(PatchCode::centre);  // before the steps

// Number of bytes that can store all numbers below count.
inline std::size_t bytes_for(std::uint64_t count) {
  return count <= 1 ? 1 : (static_cast<std::size_t>(std::bit_width(count - 1)) + 7) / 8;
}

inline std::size_t bytes_for_pixels(int size) {
  return bytes_for(std::uint64_t{pixel_codes(size)} + 1);
}

using ViewSizes = std::array<std::uint32_t, kViewSections>;

// Adds the bytes consumed between two states; in large sections modulo 2^32.
inline void set_taken(const ViewSizes& before, const ViewSizes& after, ViewSizes& taken) {
  for (std::size_t i = 0; i < taken.size(); ++i) taken[i] += before[i] - after[i];
}

}  // namespace byre
