#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Texture area of a pixel: steps to the next pixel to the right and below, in texture widths.
struct TextureFootprint {
  Eigen::Vector2f right;
  Eigen::Vector2f down;
};

// A square texture of reflectances that repeats in both directions, in halving resolutions (Williams 1983).
class MipTexture {
 public:
  // texels: size x size, row-major, 0 to 1; size is a power of two.
  MipTexture(int size, const std::vector<float>& texels);

  // Mean reflectance, 0 to 1, of a footprint around a place. Long narrow footprints, as on a floor at grazing angle,
  // are sampled at several places.
  float sample(const Eigen::Vector2f& place, const TextureFootprint& footprint) const;

  // Mean over a round footprint, its width in textures, from the nearest level only: for smooth textures.
  float sample(const Eigen::Vector2f& place, float width) const;

 private:
  float bilinear(const Eigen::Vector2f& place, int level) const;
  float trilinear(const Eigen::Vector2f& place, float level) const;
  float level_of(float width) const;
  int nearest_level(float width) const;

  int size_log2_;
  std::vector<std::uint8_t> texels_;  // all levels, finest first
  std::vector<int> first_texel_;      // index of each level's first texel
};

}  // namespace byre
