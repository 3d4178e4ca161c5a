#include "byre/simulation/mip_texture.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace byre {
namespace {

constexpr int kMaxProbes = 4;  // along a narrow footprint

std::uint8_t to_texel(float reflectance) {
  return static_cast<std::uint8_t>(std::lround(std::clamp(reflectance, 0.0f, 1.0f) * 255.0f));
}

// Averages 2 x 2 texels of the finer level.
std::vector<float> halved(const std::vector<float>& texels, int size) {
  const int half = size / 2;
  const auto at = [&](int row, int column) { return texels[static_cast<std::size_t>(row * size + column)]; };
  std::vector<float> result;
  result.reserve(texels.size() / 4);
  for (int row = 0; row < half; ++row) {
    for (int column = 0; column < half; ++column) {
      result.push_back(0.25f * (at(2 * row, 2 * column) + at(2 * row, 2 * column + 1) + at(2 * row + 1, 2 * column) +
                                at(2 * row + 1, 2 * column + 1)));
    }
  }
  return result;
}

// Accurate to 0.09, from the float's bits: sufficient for mip levels.
float rough_log2(float positive) {
  return static_cast<float>(std::bit_cast<std::int32_t>(positive)) * 0x1p-23f - 127.0f;
}

}  // namespace

MipTexture::MipTexture(int size, const std::vector<float>& texels) : size_log2_(std::countr_zero(unsigned(size))) {
  assert(std::has_single_bit(static_cast<unsigned>(size)));
  assert(texels.size() == static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
  std::vector<float> level = texels;
  for (int level_size = size; level_size > 0; level_size /= 2) {
    first_texel_.push_back(static_cast<int>(texels_.size()));
    std::ranges::transform(level, std::back_inserter(texels_), to_texel);
    level = halved(level, level_size);
  }
}

float MipTexture::bilinear(const Eigen::Vector2f& place, int level) const {
  const int log2 = size_log2_ - level;
  const int mask = (1 << log2) - 1;
  const auto scale = static_cast<float>(1 << log2);
  const float x = place.x() * scale - 0.5f;
  const float y = place.y() * scale - 0.5f;
  const float left = std::floor(x);
  const float top = std::floor(y);
  const int column = static_cast<int>(left) & mask;
  const int next_column = (column + 1) & mask;
  const int row = static_cast<int>(top) & mask;
  const std::uint8_t* const upper = &texels_[static_cast<std::size_t>(first_texel_[level] + (row << log2))];
  const std::uint8_t* const lower =
      &texels_[static_cast<std::size_t>(first_texel_[level] + (((row + 1) & mask) << log2))];
  const auto between = [part = x - left](float from, float to) { return from + part * (to - from); };
  const float above = between(upper[column], upper[next_column]);
  const float below = between(lower[column], lower[next_column]);
  return (above + (y - top) * (below - above)) * (1.0f / 255.0f);
}

float MipTexture::trilinear(const Eigen::Vector2f& place, float level) const {
  if (level <= 0.0f) return bilinear(place, 0);
  const int finer = static_cast<int>(level);
  if (finer >= size_log2_) return bilinear(place, size_log2_);
  const float fine = bilinear(place, finer);
  return fine + (level - static_cast<float>(finer)) * (bilinear(place, finer + 1) - fine);
}

float MipTexture::sample(const Eigen::Vector2f& place, const TextureFootprint& footprint) const {
  const float right = footprint.right.squaredNorm();
  const float down = footprint.down.squaredNorm();
  const Eigen::Vector2f& axis = right > down ? footprint.right : footprint.down;
  const float length = std::sqrt(std::max(right, down));
  const float width = std::sqrt(std::min(right, down));
  const int probes = std::clamp(static_cast<int>(length / std::max(width, 1e-9f) + 0.5f), 1, kMaxProbes);
  const float covered = std::max(width, length / static_cast<float>(probes));
  if (probes == 1) return trilinear(place, level_of(covered));
  const int level = nearest_level(covered);
  float sum = 0.0f;
  for (int i = 0; i < probes; ++i) {
    const float along = (static_cast<float>(i) + 0.5f) / static_cast<float>(probes) - 0.5f;
    sum += bilinear(place + along * axis, level);
  }
  return sum / static_cast<float>(probes);
}

float MipTexture::sample(const Eigen::Vector2f& place, float width) const {
  return bilinear(place, nearest_level(width));
}

// Fractional level whose texels are as wide as the footprint, in textures.
float MipTexture::level_of(float width) const {
  return rough_log2(std::max(width, 1e-9f)) + static_cast<float>(size_log2_);
}

int MipTexture::nearest_level(float width) const {
  return std::clamp(static_cast<int>(level_of(width) + 0.5f), 0, size_log2_);
}

}  // namespace byre
