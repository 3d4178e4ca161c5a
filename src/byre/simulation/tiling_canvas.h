#pragma once

#include "byre/simulation/seeded_draws.h"

#include <functional>
#include <vector>

namespace byre {

// A square texture of reflectances that tiles: strokes wrap around its borders. Units: texels.
class TilingCanvas {
 public:
  TilingCanvas(int size, float reflectance);

  int size() const { return size_; }
  const std::vector<float>& texels() const { return texels_; }

  // Sets each texel to value(column, row, current value).
  void fill(const std::function<float(int column, int row, float before)>& value);

  struct Stroke {
    float x = 0.0f, y = 0.0f;
    float direction = 0.0f;  // radians
    float length = 0.0f;
    float width = 1.0f;
    float reflectance = 0.0f;
  };
  void draw(const Stroke& stroke);

  // Strokes at random places; each property is drawn from its range.
  struct StrokeRange {
    int count = 0;
    float direction = 0.0f;  // radians, +- spread
    float spread = 3.15f;
    float length[2] = {0.0f, 0.0f};
    float width[2] = {1.0f, 1.0f};
    float reflectance[2] = {0.0f, 1.0f};
  };
  void scatter(const StrokeRange& range, SeededDraws& draws);

  // A meandering line, as of a crack.
  void crack(Stroke start, int pieces, SeededDraws& draws);

 private:
  float& texel(int column, int row);

  int size_;
  std::vector<float> texels_;  // size x size, row-major
};

// Tiling fractal value noise with period size, about -1 to 1, row-major. The first octave has cells_x by cells_y cells;
// each next one has twice as many along each side and 0.6 of the amplitude.
std::vector<float> tiling_noise(int size, int cells_x, int cells_y, int octaves, std::uint64_t seed);

}  // namespace byre
