#pragma once

#include "byre/slam/hidden_cells.h"

#include <array>
#include <span>

namespace byre {

// A point seen in another cell shortly before, searched at its present prediction.
struct LensTrial {
  Eigen::Vector2d pixel;
  bool is_found = false;
};

// Detects image cells behind dirt by points that other cells showed just before. Points that are occluded, dark or
// moved were not seen there either, so they are no evidence. Each cell has a sequential likelihood-ratio test (Page
// 1954) of two hypotheses: points are found nearly as often as in the rest of the image, or hardly ever. A cell is
// dirty once the second reaches a threshold, and clean again once the first has outweighed it.
class LensMask {
 public:
  // Adds the trials of a frame. Too few trials to compare a cell with the rest are kept for the next frame.
  void note(std::span<const LensTrial> trials, const Rig& rig);

  const HiddenCells& hidden() const { return hidden_; }

 private:
  struct Count {
    int found = 0;
    int all = 0;
  };

  bool is_beside_dirt(std::size_t cell) const;

  std::array<double, HiddenCells::kCells> evidence_{};  // log-likelihood ratio of dirty to clean
  std::array<Count, HiddenCells::kCells> counts_{};     // pending trials
  HiddenCells hidden_;
};

}  // namespace byre
