#pragma once

#include "byre/rig.h"

#include <algorithm>
#include <vector>

namespace byre {

// A smooth field over an image, interpolated bilinearly between the nodes of a grid.
template <typename Value>
class PixelGrid {
 public:
  // value_at(pixel) is called once for each node.
  template <typename Function>
  PixelGrid(int width, int height, Function value_at)
      : columns_(2 + (width - 2) / kCell), rows_(2 + (height - 2) / kCell) {
    nodes_.reserve(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_));
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        const Eigen::Vector2d node(std::min(column * kCell, width - 1), std::min(row * kCell, height - 1));
        nodes_.push_back(value_at(node));
      }
    }
    last_cell_width_ = width - 1 - (columns_ - 2) * kCell;
    last_cell_height_ = height - 1 - (rows_ - 2) * kCell;
  }

  // Outside the image: the value at the nearest pixel inside.
  Value at(const Eigen::Vector2d& pixel) const {
    const Place x = place(pixel.x(), columns_, last_cell_width_);
    const Place y = place(pixel.y(), rows_, last_cell_height_);
    const Value* const upper = &nodes_[static_cast<std::size_t>(y.cell * columns_ + x.cell)];
    const Value* const lower = upper + columns_;
    return (1.0 - y.fraction) * ((1.0 - x.fraction) * upper[0] + x.fraction * upper[1]) +
           y.fraction * ((1.0 - x.fraction) * lower[0] + x.fraction * lower[1]);
  }

 private:
  static constexpr int kCell = 16;  // pixels

  struct Place {
    int cell = 0;
    double fraction = 0.0;
  };

  static Place place(double coordinate, int nodes, int last_cell) {
    const int cell = std::clamp(static_cast<int>(coordinate / kCell), 0, nodes - 2);
    const double size = cell == nodes - 2 ? last_cell : kCell;
    return {cell, std::clamp((coordinate - cell * kCell) / size, 0.0, 1.0)};
  }

  int columns_ = 0;
  int rows_ = 0;
  int last_cell_width_ = 0;   // pixels
  int last_cell_height_ = 0;  // pixels
  std::vector<Value> nodes_;  // row by row
};

}  // namespace byre
