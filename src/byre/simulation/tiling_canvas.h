#pragma once

#include "byre/simulation/seeded_draws.h"

#include <functional>
#include <vector>

namespace byre {

// A square picture of reflectances to draw on, in texels; what leaves it on one side enters it on the other.
class TilingCanvas {
 public:
  TilingCanvas(int size, float reflectance);

  int size() const { return size_; }
  const std::vector<float>& texels() const { return texels_; }

  // Replaces each texel by what value gives for its column, row and value so far.
  void fill(const std::function<float(int column, int row, float before)>& value);

  struct Stroke {
    float x = 0.0f, y = 0.0f;  // place where it begins
    float direction = 0.0f;    // radians
    float length = 0.0f;
    float width = 1.0f;
    float reflectance = 0.0f;
  };
  void draw(const Stroke& stroke);

  // Many strokes at random places; each number lies between the two of a range.
  struct StrokeRange {
    int count = 0;
    float direction = 0.0f;  // radians, plus or minus spread
    float spread = 3.15f;
    float length[2] = {0.0f, 0.0f};
    float width[2] = {1.0f, 1.0f};
    float reflectance[2] = {0.0f, 1.0f};
  };
  void scatter(const StrokeRange& range, SeededDraws& draws);

  // A line that wanders, as a crack does.
  void crack(Stroke start, int pieces, SeededDraws& draws);

 private:
  float& texel(int column, int row);

  int size_;
  std::vector<float> texels_;  // size x size, row-major
};

// Fractal value noise that repeats after size texels, about -1 to 1, row-major: octaves with cells_x by cells_y cells
// at first, then twice as many each, and 0.6 of the amplitude.
std::vector<float> tiling_noise(int size, int cells_x, int cells_y, int octaves, std::uint64_t seed);

}  // namespace byre
