#pragma once

#include "byre/slam/hidden_cells.h"

#include <array>
#include <span>

namespace byre {

// A point that was seen elsewhere in the image shortly before, looked for where it should be now.
struct LensTrial {
  Eigen::Vector2d pixel;
  bool is_found = false;
};

// Tells which cells of an image dirt hides, by points that other cells have shown just before. What is hidden by
// things, dark, or not where the map has it, was not seen there either, and says nothing. For each cell two hypotheses
// are weighed: it shows points nearly as often as the rest of the image, or hardly any. A cell is dirty once the second
// explains what came so much better that chance does not do that, however long one looks (Page 1954), and clean again
// once the first one explains it as well.
class LensMask {
 public:
  // The trials of one frame. Where they are too few to compare a cell with the rest, they wait for those of the next.
  void note(std::span<const LensTrial> trials, const Rig& rig);

  const HiddenCells& hidden() const { return hidden_; }

 private:
  struct Count {
    int found = 0;
    int all = 0;
  };

  bool is_beside_dirt(std::size_t cell) const;

  std::array<double, HiddenCells::kCells> evidence_{};  // logarithm of the likelihood ratio, of being dirty to clean
  std::array<Count, HiddenCells::kCells> counts_{};     // trials that wait
  HiddenCells hidden_;
};

}  // namespace byre
