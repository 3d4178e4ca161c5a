#include "byre/simulation/surface_texture.h"
#include "byre/simulation/smooth_step.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

struct Cell {
  std::int32_t column = 0;
  std::int32_t row = 0;
  float x = 0.0f;  // position within the cell, 0 to 1
  float y = 0.0f;
};

Cell cell_at(const SurfaceSpot& spot, float size) {
  const float x = spot.x / size;
  const float y = spot.y / size;
  const float column = std::floor(x);
  const float row = std::floor(y);
  return {static_cast<std::int32_t>(column), static_cast<std::int32_t>(row), x - column, y - row};
}

std::uint64_t hash_of(std::uint64_t seed, std::int32_t column, std::int32_t row) {
  return hash(seed, static_cast<std::uint32_t>(column), static_cast<std::uint32_t>(row));
}

// Byte index of bits, mapped to [low, high].
float byte_between(std::uint64_t bits, int index, float low, float high) {
  return low + (high - low) / 255.0f * static_cast<float>((bits >> (8 * index)) & 0xff);
}

// Visible share of detail of a size: 1 above four footprints, 0 below two.
float visible_part(float size, float footprint) {
  return std::clamp(0.5f * size / footprint - 1.0f, 0.0f, 1.0f);
}

// Faster than std::lerp; not exact at the far end.
float mix(float from, float to, float part) {
  return from + part * (to - from);
}

// Value noise (lattice of values, not gradients), -1 to 1.
float value_noise(std::uint64_t seed, const SurfaceSpot& spot, float wavelength) {
  const Cell cell = cell_at(spot, wavelength);
  const auto value = [&](std::int32_t column, std::int32_t row) {
    return byte_between(hash_of(seed, cell.column + column, cell.row + row), 0, -1.0f, 1.0f);
  };
  const float x = smooth_step(cell.x);
  const float y = smooth_step(cell.y);
  const float top = mix(value(0, 0), value(1, 0), x);
  const float bottom = mix(value(0, 1), value(1, 1), x);
  return mix(top, bottom, y);
}

struct Shape {
  enum class Kind : std::uint8_t { none, disc, half_disc, rectangle };
  Kind kind = Kind::none;
  float grey = 0.0f;
  float x = 0.0f;  // centre and half sizes in cells; the shape stays inside its cell
  float y = 0.0f;
  float half_length = 0.0f;
  float half_width = 0.0f;
  float cosine = 1.0f;  // cosine of the angle from the cell's x axis to the shape's long side
  float sine = 0.0f;
};

struct Direction {
  float cosine;
  float sine;
};

// 64 precomputed directions around the circle.
const std::array<Direction, 64>& directions() {
  static const std::array<Direction, 64> kDirections = [] {
    std::array<Direction, 64> all{};
    for (std::size_t i = 0; i < all.size(); ++i) {
      const float angle = 2.0f * std::numbers::pi_v<float> * static_cast<float>(i) / static_cast<float>(all.size());
      all[i] = {std::cos(angle), std::sin(angle)};
    }
    return all;
  }();
  return kDirections;
}

Shape draw_shape(std::uint64_t bits) {
  const auto [cosine, sine] = directions()[(bits >> 48) & 63];
  return {.kind = static_cast<Shape::Kind>(bits >> 62),
          .grey = byte_between(bits, 0, 15.0f, 240.0f),
          .x = byte_between(bits, 1, 0.36f, 0.64f),
          .y = byte_between(bits, 2, 0.36f, 0.64f),
          .half_length = byte_between(bits, 3, 0.14f, 0.28f),
          .half_width = byte_between(bits, 4, 0.10f, 0.22f),
          .cosine = cosine,
          .sine = sine};
}

// Signed distance to the outline in cells, negative inside; a lower bound near corners, sufficient within a pixel.
float signed_distance(const Shape& shape, const Cell& cell) {
  const float dx = cell.x - shape.x;
  const float dy = cell.y - shape.y;
  const float along = shape.cosine * dx + shape.sine * dy;
  const float across = shape.cosine * dy - shape.sine * dx;
  const float to_rectangle = std::max(std::abs(along) - shape.half_length, std::abs(across) - shape.half_width);
  const float to_disc = std::sqrt(dx * dx + dy * dy) - shape.half_length;
  switch (shape.kind) {
    case Shape::Kind::rectangle:
      return to_rectangle;
    case Shape::Kind::half_disc:
      return std::max(to_disc, along);
    default:
      return to_disc;
  }
}

// Draws a layer of shapes, one per cell, over a grey value. Outlines are blurred over one footprint.
float cover_with_shapes(float grey, std::uint64_t seed, const SurfaceSpot& spot, float cell_size) {
  constexpr float kDetail = 0.4f;  // typical size of a shape, as a share of its cell
  const float opacity = visible_part(kDetail * cell_size, 0.5f * spot.footprint);
  if (opacity == 0.0f) return grey;
  const Cell cell = cell_at(spot, cell_size);
  const Shape shape = draw_shape(hash_of(seed, cell.column, cell.row));
  if (shape.kind == Shape::Kind::none) return grey;
  const float distance = signed_distance(shape, cell) * cell_size;
  const float coverage = std::clamp(0.5f - distance / spot.footprint, 0.0f, 1.0f);
  return mix(grey, shape.grey, opacity * coverage);
}

}  // namespace

std::uint64_t hash(std::uint64_t seed, std::uint64_t first, std::uint64_t second) {
  std::uint64_t bits = seed + first * 0x9e3779b97f4a7c15 + second * 0xc2b2ae3d27d4eb4f;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111eb;
  return bits ^ (bits >> 31);
}

float surface_grey(std::uint64_t seed, const SurfaceSpot& spot) {
  struct Layer {
    float size;       // metres
    float amplitude;  // grey values
  };
  constexpr std::array<Layer, 4> kNoise{{{1.7f, 40.0f}, {0.45f, 25.0f}, {0.13f, 18.0f}, {0.045f, 12.0f}}};
  constexpr std::array<float, 4> kShapeCells{0.95f, 0.41f, 0.17f, 0.073f};  // metres, largest first

  float grey = byte_between(hash(seed, 0, 0), 0, 95.0f, 160.0f);  // base grey of the surface
  for (const float cell_size : kShapeCells) grey = cover_with_shapes(grey, ++seed, spot, cell_size);
  for (const auto& [size, amplitude] : kNoise) {
    const float visible = visible_part(size, spot.footprint);
    if (visible > 0.0f) grey += visible * amplitude * value_noise(++seed, spot, size);
  }
  return std::clamp(grey, 0.0f, 255.0f);
}

}  // namespace byre
