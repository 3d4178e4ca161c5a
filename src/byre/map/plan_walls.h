#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace byre {

// A place on a plan that is not known exactly: somewhere within the radius about its centre, metres.
struct PlanDisc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

// The walls of a floor plan, as a grid of cells with one or none in each, and where a way between them leads. A robot
// is a point, so every gap is a door; what lies beyond the plan's image is open.
class PlanWalls {
 public:
  // A cell has a wall if it contains an occupied pixel (100). Cells are at least 0.1 m wide, and wide enough that a
  // line of pixels is a line of cells. occupancy: of the plan's pixels (DrawnFloorPlan).
  PlanWalls(const FloorPlan& plan, std::span<const std::int8_t> occupancy);

  // Opens the walls along ways that were driven, which may lead through a door that is drawn shut. All that free cells
  // connect with them can be driven to.
  void open_along(std::span<const std::vector<Eigen::Vector2d>> ways_in_plan);

  // Whether some place in the disc is in no wall; and whether one is that can be driven to besides.
  bool has_free_place(const PlanDisc& disc) const;
  bool has_place_to_drive_to(const PlanDisc& disc) const;

  // The length of the shortest way from one disc to the other; empty if there is none of the given length, metres.
  std::optional<double> way_between(const PlanDisc& start, const PlanDisc& end, double longest) const;

 private:
  struct Cell {
    int column = 0;
    int row = 0;
  };

  Cell cell_at(const Eigen::Vector2d& point_in_plan) const;  // the nearest one
  std::size_t index(Cell cell) const { return static_cast<std::size_t>(cell.row) * columns_ + cell.column; }
  bool is_inside(Cell cell) const;
  bool is_wall(Cell cell) const { return is_wall_[index(cell)] != 0; }
  bool may_step(Cell from, int right, int down) const;
  template <typename Accept>
  bool any_in(const PlanDisc& disc, const Accept& accept) const;
  void flood(std::vector<Cell> front);

  double cell_ = 0.1;                                         // metres
  Eigen::Vector2d corner_in_plan_ = Eigen::Vector2d::Zero();  // lower left one of the grid
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> is_wall_;     // one for each cell
  std::vector<std::uint8_t> is_reached_;  // whether it can be driven to, one for each cell
};

}  // namespace byre
