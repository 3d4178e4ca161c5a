#pragma once

#include "byre/simulation/mip_texture.h"

#include <array>
#include <cstdint>
#include <vector>

namespace byre {

// Procedural pictures of barn surfaces. The signs form a grid of kSignsPerSide x kSignsPerSide.
enum class BarnPicture : std::uint8_t {
  concrete,  // cracks, stains, gravel
  planks,    // upright boards with grain, knots and gaps
  timber,    // grain along v
  straw,
  feed,
  rust,        // galvanised steel with first rust
  roof_sheet,  // corrugated, waves across u
  hide,        // coat of cattle
  plastic,
  dung,   // wet concrete behind the fence
  signs,  // boards with numbers and marks
  stains  // large and smooth, about 0.5: multiplies other pictures to hide their repetition
};
inline constexpr int kBarnPictures = 12;
inline constexpr int kSignsPerSide = 4;

using BarnPictures = std::vector<MipTexture>;  // one per BarnPicture, in its order

// Deterministic in the seed for any number of threads (0: one per core).
BarnPictures draw_barn_pictures(std::uint64_t seed, int threads);

inline const MipTexture& picture_of(const BarnPictures& pictures, BarnPicture picture) {
  return pictures[static_cast<std::size_t>(picture)];
}

}  // namespace byre
