#pragma once

#include "byre/slam/tracking/image_mask.h"

#include <array>
#include <span>

namespace byre {

// A point seen in another cell shortly before, searched at its present prediction.
struct DirtTrial {
  Eigen::Vector2d pixel;
  bool is_found = false;
};

// Detects image cells behind dirt by points that other cells showed just before. Points that are occluded, dark or
// moved were not seen there either, so they are no evidence. Each cell has a sequential likelihood-ratio test (Page
// 1954) of two hypotheses: points are found nearly as often as in the rest of the image, or hardly ever. A cell is
// dirty once the second reaches a threshold, and clean again once the first has outweighed it.
class DirtMask {
 public:
  // Adds the trials of a frame. Too few trials to compare a cell with the rest are kept for the next frame.
  void note(std::span<const DirtTrial> trials, const Rig& rig);

  const ImageMask& hidden() const { return hidden_; }

 private:
  struct Count {
    int found = 0;
    int all = 0;
  };

  bool is_next_to_dirt(std::size_t cell) const;

  std::array<double, ImageMask::kCells> evidence_{};  // log-likelihood ratio of dirty to clean
  std::array<Count, ImageMask::kCells> counts_{};     // pending trials
  ImageMask hidden_;
};

}  // namespace byre
