#pragma once

#include "byre/floor_plan.h"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace byre {

// An uncertain position on a plan: within the radius around its centre, metres.
struct PlanDisc {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius = 0.0;
};

// Walls of a floor plan as an occupancy grid, with path search. The robot is a point, so that every gap is passable.
// The area outside the plan's image is free.
class PlanWalls {
 public:
  // A cell is a wall if it contains an occupied pixel (100). Cells are at least 0.1 m wide, and wide enough that a line
  // of pixels becomes a closed line of cells. occupancy: of the plan's pixels (DrawnFloorPlan).
  PlanWalls(const FloorPlan& plan, std::span<const std::int8_t> occupancy);

  // Frees the cells along driven paths, which may pass a door drawn closed, and marks all connected free cells
  // reachable.
  void clear_along_paths(std::span<const std::vector<Eigen::Vector2d>> paths_in_plan);

  // Whether the disc contains a free cell; whether it contains a free, reachable cell.
  bool has_free_cell(const PlanDisc& disc) const;
  bool has_reachable_cell(const PlanDisc& disc) const;

  // Length of the shortest path between two discs, metres; empty if it exceeds `longest`.
  std::optional<double> path_length_between(const PlanDisc& start, const PlanDisc& end, double longest) const;

 private:
  struct Cell {
    int column = 0;
    int row = 0;
  };

  Cell cell_at(const Eigen::Vector2d& point_in_plan) const;  // the nearest cell
  std::size_t index(Cell cell) const { return static_cast<std::size_t>(cell.row) * columns_ + cell.column; }
  bool is_inside(Cell cell) const;
  bool is_wall(Cell cell) const { return is_wall_[index(cell)] != 0; }
  bool can_step(Cell from, int right, int down) const;
  template <typename Accept>
  bool any_in(const PlanDisc& disc, const Accept& accept) const;
  void flood(std::vector<Cell> front);

  double cell_ = 0.1;                                         // metres
  Eigen::Vector2d corner_in_plan_ = Eigen::Vector2d::Zero();  // lower left corner of the grid
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint8_t> is_wall_;     // per cell
  std::vector<std::uint8_t> is_reached_;  // per cell: reachable from driven paths
};

}  // namespace byre
