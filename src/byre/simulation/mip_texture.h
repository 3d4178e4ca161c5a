#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace byre {

// What a pixel covers of a texture: the steps to the next pixel to the right and below, in widths of the picture.
struct TextureFootprint {
  Eigen::Vector2f right;
  Eigen::Vector2f down;
};

// A square picture of reflectances that repeats in both directions, in halving resolutions (Williams 1983).
class MipTexture {
 public:
  // texels: size x size, row-major, 0 to 1; size is a power of two.
  MipTexture(int size, const std::vector<float>& texels);

  // The mean reflectance, 0 to 1, of what a pixel covers around a place. Footprints that are long and narrow, as of a
  // floor seen at a slant, are looked up in several places along them.
  float sample(const Eigen::Vector2f& place, const TextureFootprint& footprint) const;

  // The mean over a round footprint of a width in pictures, from the level next to it alone: for what is smooth.
  float sample(const Eigen::Vector2f& place, float width) const;

 private:
  float bilinear(const Eigen::Vector2f& place, int level) const;
  float trilinear(const Eigen::Vector2f& place, float level) const;
  float level_of(float width) const;
  int nearest_level(float width) const;

  int size_log2_;
  std::vector<std::uint8_t> texels_;  // all levels, one after the other, the finest first
  std::vector<int> first_texel_;      // index of each level's first texel
};

}  // namespace byre
