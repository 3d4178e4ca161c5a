#pragma once

#include "byre/floor_plan.h"

#include <algorithm>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Distances from the walls of a plan on a grid along its axes. Positions are relative to the grid's lower left corner,
// metres.
class WallDistances {
 public:
  static constexpr double kReach = 0.6;  // metres, largest distance that is measured

  explicit WallDistances(const DrawnFloorPlan& drawn);

  bool has_walls() const { return std::ranges::find(distances_, 0.0F) != distances_.end(); }
  const Eigen::Vector2d& corner_in_plan() const { return corner_; }
  Eigen::Vector2d size() const { return cell_ * Eigen::Vector2d(columns_, rows_); }

  // Distance of each cell from the nearest wall, up to kReach; row-major from the lower left.
  const std::vector<float>& distances() const { return distances_; }

  // Index of a position's cell; 0 outside the grid, whose corners are far from walls.
  std::size_t index_at(const Eigen::Vector2d& position) const {
    const double column = position.x() / cell_, row = position.y() / cell_;
    if (!(column >= 0.0 && row >= 0.0 && column < columns_ && row < rows_)) return 0;
    return static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
  }

  double at(const Eigen::Vector2d& position) const { return distances_[index_at(position)]; }

  // Nearest line of a wall: its middle, or the surface of a wall thicker than 0.4 m.
  struct WallLine {
    Eigen::Vector2d position;
    Eigen::Vector2d normal;
    double distance = 0.0;  // metres from the surface
  };
  std::optional<WallLine> line_near(const Eigen::Vector2d& position) const;  // empty far from surfaces

 private:
  double distance_from_surface(const Eigen::Vector2d& position) const;  // metres, negative inside walls; bilinear
  // Distances of all cells from the nearest cell of a kind, up to kReach.
  std::vector<float> distances_from(const std::vector<std::uint8_t>& kinds, std::uint8_t kind) const;

  // Constant after construction.
  double cell_ = 0.0;                                 // metres
  Eigen::Vector2d corner_ = Eigen::Vector2d::Zero();  // lower left, on the plan
  int columns_ = 0;
  int rows_ = 0;
  std::vector<float> distances_;
  std::vector<float> depths_;  // inside walls, from the nearest free cell; 0 outside
};

}  // namespace byre
