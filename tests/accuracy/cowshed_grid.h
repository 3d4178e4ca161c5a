#pragma once

#include "byre/floor_plan.h"
#include "byre/simulation/cowshed/cowshed_recording.h"

#include <cstdint>
#include <span>
#include <vector>

namespace byre {

// Simulated barn seen from above, for the comparison of occupancy grids. Pixels of the drawn plan, row-major from the
// top left.
struct BarnFromAbove {
  FloorPlan plan;
  std::vector<std::uint8_t> is_wall;    // drawn walls, posts and curbs
  std::vector<std::uint8_t> is_solid;   // walls, and surfaces between the heights: gates, feed, movable objects
  std::vector<std::uint8_t> is_seen;    // surfaces between the heights in a left image, within the range
  std::vector<Eigen::Vector2d> driven;  // true positions of the body
};

struct BarnView {
  double low = 0.1;  // heights, metres
  double high = 1.8;
  double range = 8.0;       // metres from the camera
  double interval_s = 0.5;  // between the images
};

BarnFromAbove barn_from_above(const CowshedRecording& recording, const BarnView& view);

struct GridScore {
  int walls = 0;            // plan's wall pixels in view: at most 5 cm from a seen surface
  double found = 0.0;       // share of these with an occupied cell within 10 cm
  int occupied = 0;         // cells
  double right = 0.0;       // share of these with a wall or object within 10 cm
  int driven_occupied = 0;  // occupied cells on the true path
};

// The grid is in the frame of the plan.
GridScore score_of(const FloorPlan& grid, std::span<const std::int8_t> occupancy, const BarnFromAbove& barn);

}  // namespace byre
