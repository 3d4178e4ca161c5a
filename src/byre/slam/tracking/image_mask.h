#pragma once

#include "byre/rig.h"

#include <algorithm>
#include <bitset>
#include <cstddef>

#include <Eigen/Core>

namespace byre {

// Image cells that show nothing of the world, such as cells behind dirt. No points are expected there.
class ImageMask {
 public:
  static constexpr int kColumns = 16, kRows = 10;
  static constexpr auto kCells = static_cast<std::size_t>(kColumns * kRows);

  // Cell of a pixel, row by row; the nearest cell for pixels outside the image.
  static std::size_t cell_of(const Eigen::Vector2d& pixel, const Rig& rig) {
    const int column = std::clamp(static_cast<int>(kColumns * pixel.x() / rig.width), 0, kColumns - 1);
    const int row = std::clamp(static_cast<int>(kRows * pixel.y() / rig.height), 0, kRows - 1);
    return static_cast<std::size_t>(row * kColumns + column);
  }

  void set(std::size_t cell, bool is_hidden) { cells_.set(cell, is_hidden); }
  bool is_hidden(std::size_t cell) const { return cells_.test(cell); }
  bool hides(const Eigen::Vector2d& pixel, const Rig& rig) const { return cells_.test(cell_of(pixel, rig)); }
  bool any() const { return cells_.any(); }
  double share() const { return static_cast<double>(cells_.count()) / kCells; }  // share of the image

  bool operator==(const ImageMask&) const = default;

 private:
  std::bitset<kCells> cells_;
};

}  // namespace byre
