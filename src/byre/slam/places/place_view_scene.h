#pragma once

// Synthetic views of an offline map for tests of place hypotheses.

#include "byre/slam/places/place_view.h"

namespace byre {

inline CellInView cell_in_view(const std::array<int, 3>& cell, int seen) {
  constexpr double kSide = 2.0;  // metres
  const Eigen::Vector3d centre(cell[0] + 0.5, cell[1] + 0.5, cell[2] + 0.5);
  return {cell, 40, seen, kSide * centre, 40, seen};
}

// Cells of a room, first the agreeing ones, then the others. No four of them fit on one moved object.
inline PlaceView view_of_room(int agreeing, int disagreeing, int seen = 10) {
  PlaceView view{.is_near_keyframe = true, .cells = {}};
  for (int i = 0; i < agreeing + disagreeing; ++i) {
    view.cells.push_back(cell_in_view({i, i % 3, i % 2}, i < agreeing ? seen : 0));
  }
  return view;
}

}  // namespace byre
