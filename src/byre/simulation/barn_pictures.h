#pragma once

#include "byre/simulation/mip_texture.h"

#include <array>
#include <cstdint>
#include <vector>

namespace byre {

// What surfaces of a barn are covered with, drawn by rule. The signs lie in a grid of kSignsPerSide x kSignsPerSide.
enum class BarnPicture : std::uint8_t {
  concrete,  // cracks, stains, gravel
  planks,    // upright boards with grain, knots and gaps
  timber,    // grain along v
  straw,
  feed,
  rust,        // galvanised steel that has begun to rust
  roof_sheet,  // corrugated, waves across u
  hide,        // coat of cattle
  plastic,
  dung,   // wet concrete behind the fence
  signs,  // boards with numbers and marks
  stains  // large and smooth, about 0.5: multiplies the others, so that they do not repeat
};
inline constexpr int kBarnPictures = 12;
inline constexpr int kSignsPerSide = 4;

using BarnPictures = std::vector<MipTexture>;  // one for each BarnPicture, in its order

// The same seed gives the same pictures, whatever the number of threads (0: as many as the machine has).
BarnPictures draw_barn_pictures(std::uint64_t seed, int threads);

inline const MipTexture& picture_of(const BarnPictures& pictures, BarnPicture picture) {
  return pictures[static_cast<std::size_t>(picture)];
}

}  // namespace byre
