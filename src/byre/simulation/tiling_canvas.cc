#include "byre/simulation/tiling_canvas.h"
#include "byre/simulation/smooth_step.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

std::vector<float> lattice_values(int cells_x, int cells_y, std::uint64_t seed) {
  SeededDraws draws(seed, static_cast<std::uint64_t>(cells_x) << 32 | static_cast<std::uint64_t>(cells_y));
  std::vector<float> values(static_cast<std::size_t>(cells_x) * static_cast<std::size_t>(cells_y));
  for (float& value : values) value = draws.between(-1.0f, 1.0f);
  return values;
}

// Values of one lattice row, interpolated along x.
std::vector<float> interpolated_row(const float* lattice_row, int cells_x, int size) {
  std::vector<float> values;
  for (int column = 0; column < size; ++column) {
    const float x = static_cast<float>(column * cells_x) / static_cast<float>(size);
    const int cell = static_cast<int>(x);
    const int next = (cell + 1) % cells_x;
    const float right = smooth_step(x - static_cast<float>(cell));
    values.push_back(lattice_row[cell] + right * (lattice_row[next] - lattice_row[cell]));
  }
  return values;
}

void add_octave(std::vector<float>& sum, int size, int cells_x, int cells_y, float amplitude, std::uint64_t seed) {
  const std::vector<float> lattice = lattice_values(cells_x, cells_y, seed);
  std::vector<std::vector<float>> rows;
  for (int cell_row = 0; cell_row < cells_y; ++cell_row) {
    rows.push_back(interpolated_row(&lattice[static_cast<std::size_t>(cell_row * cells_x)], cells_x, size));
  }
  for (int row = 0; row < size; ++row) {
    const float y = static_cast<float>(row * cells_y) / static_cast<float>(size);
    const int cell_row = static_cast<int>(y);
    const float down = smooth_step(y - static_cast<float>(cell_row));
    const float* const above = rows[static_cast<std::size_t>(cell_row)].data();
    const float* const below = rows[static_cast<std::size_t>((cell_row + 1) % cells_y)].data();
    float* const values = &sum[static_cast<std::size_t>(row) * static_cast<std::size_t>(size)];
    for (int column = 0; column < size; ++column) {
      values[column] += amplitude * (above[column] + down * (below[column] - above[column]));
    }
  }
}

}  // namespace

std::vector<float> tiling_noise(int size, int cells_x, int cells_y, int octaves, std::uint64_t seed) {
  std::vector<float> sum(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), 0.0f);
  float amplitude = 0.8f;
  for (int octave = 0; octave < octaves && std::max(cells_x, cells_y) <= size; ++octave) {
    add_octave(sum, size, cells_x, cells_y, amplitude, hash(seed, static_cast<std::uint64_t>(octave), 1));
    cells_x *= 2;
    cells_y *= 2;
    amplitude *= 0.6f;
  }
  return sum;
}

TilingCanvas::TilingCanvas(int size, float reflectance)
    : size_(size), texels_(static_cast<std::size_t>(size) * static_cast<std::size_t>(size), reflectance) {}

float& TilingCanvas::texel(int column, int row) {
  const int mask = size_ - 1;
  return texels_[static_cast<std::size_t>((row & mask) * size_ + (column & mask))];
}

void TilingCanvas::fill(const std::function<float(int column, int row, float before)>& value) {
  for (int row = 0; row < size_; ++row) {
    for (int column = 0; column < size_; ++column) texel(column, row) = value(column, row, texel(column, row));
  }
}

void TilingCanvas::draw(const Stroke& stroke) {
  const float along_x = std::cos(stroke.direction);
  const float along_y = std::sin(stroke.direction);
  const bool is_flat = std::abs(along_x) > std::abs(along_y);
  const float slope = is_flat ? along_y / along_x : along_x / along_y;
  const float reach = stroke.length * (is_flat ? along_x : along_y);
  const int steps = std::max(static_cast<int>(std::abs(reach)), static_cast<int>(stroke.width) - 1);
  const float half_width = 0.5f * stroke.width * std::sqrt(1.0f + slope * slope);
  const int margin = static_cast<int>(half_width + 1.0f);
  for (int step = 0; step <= steps; ++step) {
    const float along = reach < 0.0f ? static_cast<float>(-step) : static_cast<float>(step);
    const float centre = (is_flat ? stroke.y : stroke.x) + slope * along;
    const int main = static_cast<int>(std::floor((is_flat ? stroke.x : stroke.y) + along));
    for (int i = -margin; i <= margin; ++i) {
      const float across = std::floor(centre) + static_cast<float>(i);
      const float coverage = std::clamp(half_width + 0.5f - std::abs(across - centre), 0.0f, 1.0f);
      const int other = static_cast<int>(across);
      float& covered = is_flat ? texel(main, other) : texel(other, main);
      covered += coverage * (stroke.reflectance - covered);
    }
  }
}

void TilingCanvas::scatter(const StrokeRange& range, SeededDraws& draws) {
  const auto side = static_cast<float>(size_);
  for (int i = 0; i < range.count; ++i) {
    draw({.x = draws.between(0.0f, side),
          .y = draws.between(0.0f, side),
          .direction = range.direction + range.spread * draws.between(-1.0f, 1.0f),
          .length = draws.between(range.length[0], range.length[1]),
          .width = draws.between(range.width[0], range.width[1]),
          .reflectance = draws.between(range.reflectance[0], range.reflectance[1])});
  }
}

void TilingCanvas::crack(Stroke start, int pieces, SeededDraws& draws) {
  for (int i = 0; i < pieces; ++i) {
    draw(start);
    start.x += start.length * std::cos(start.direction);
    start.y += start.length * std::sin(start.direction);
    start.direction += draws.between(-0.7f, 0.7f);
  }
}

}  // namespace byre
