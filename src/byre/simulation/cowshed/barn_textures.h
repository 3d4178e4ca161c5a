#pragma once

#include "byre/simulation/mip_texture.h"

#include <cstdint>
#include <vector>

namespace byre {

// Procedural textures of barn surfaces. The signs form a grid of kSignsPerSide x kSignsPerSide.
enum class BarnTexture : std::uint8_t {
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
  stains  // large and smooth, about 0.5: multiplies other textures to hide their repetition
};
inline constexpr int kBarnTextures = 12;
inline constexpr int kSignsPerSide = 4;

using BarnTextures = std::vector<MipTexture>;  // one per BarnTexture, in its order

// Deterministic in the seed for any number of threads (0: one per core).
BarnTextures draw_barn_textures(std::uint64_t seed, int threads);

inline const MipTexture& texture_of(const BarnTextures& textures, BarnTexture texture) {
  return textures[static_cast<std::size_t>(texture)];
}

}  // namespace byre
