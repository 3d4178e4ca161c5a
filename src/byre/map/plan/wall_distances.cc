#include "byre/map/plan/wall_distances.h"

#include <cmath>
#include <limits>

namespace byre {

using Eigen::Vector2d;

WallDistances::WallDistances(const DrawnFloorPlan& drawn) {
  const FloorPlan& plan = drawn.plan;
  const double pixel = std::sqrt(std::abs(plan.metres_per_pixel.determinant()));
  cell_ = std::max(0.05, pixel);
  Vector2d top = Vector2d::Constant(-std::numeric_limits<double>::infinity());
  corner_ = -top;
  for (const Vector2d& at :
       {Vector2d(0, 0), Vector2d(plan.width, 0), Vector2d(0, plan.height), Vector2d(plan.width, plan.height)}) {
    corner_ = corner_.cwiseMin(plan.point_at(at));
    top = top.cwiseMax(plan.point_at(at));
  }
  corner_.array() -= kReach + 0.5 * cell_;  // pixels have their centre in the middle of a cell
  top.array() += kReach + 0.5 * cell_;
  columns_ = static_cast<int>((top.x() - corner_.x()) / cell_) + 1;
  rows_ = static_cast<int>((top.y() - corner_.y()) / cell_) + 1;
  std::vector<std::uint8_t> is_wall(static_cast<std::size_t>(columns_) * rows_);
  for (int row = 0; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      if (drawn.occupancy[static_cast<std::size_t>(row) * plan.width + column] != kOccupiedPixel) continue;
      const Vector2d at = (plan.point_at({column, row}) - corner_) / cell_;
      is_wall[static_cast<std::size_t>(at.y()) * columns_ + static_cast<std::size_t>(at.x())] = 1;
    }
  }
  distances_ = distances_from(is_wall, 1);
  depths_ = distances_from(is_wall, 0);
}

std::optional<WallDistances::WallLine> WallDistances::line_near(const Vector2d& position) const {
  constexpr double kThickest = 0.4;  // metres
  const double distance = distance_from_surface(position);
  if (std::abs(distance) >= kReach - 2.0 * cell_) return std::nullopt;
  const Vector2d x(cell_, 0.0), y(0.0, cell_);
  const Vector2d gradient(distance_from_surface(position + x) - distance_from_surface(position - x),
                          distance_from_surface(position + y) - distance_from_surface(position - y));
  if (!(gradient.norm() > cell_)) return std::nullopt;  // half-way between surfaces
  const Vector2d normal = gradient.normalized(), surface = position - distance * normal;
  double thickness = cell_;
  while (thickness < kThickest && distance_from_surface(surface - thickness * normal) < 0.0) thickness += 0.5 * cell_;
  return WallLine{surface - (thickness < kThickest ? 0.5 * thickness : 0.0) * normal, normal, std::abs(distance)};
}

double WallDistances::distance_from_surface(const Vector2d& position) const {
  const Vector2d at = position / cell_ - Vector2d::Constant(0.5);
  const double column = std::clamp(at.x(), 0.0, columns_ - 1.001), row = std::clamp(at.y(), 0.0, rows_ - 1.001);
  const auto left = static_cast<std::size_t>(column), low = static_cast<std::size_t>(row);
  const double u = column - static_cast<double>(left), v = row - static_cast<double>(low);
  const auto value = [&](std::size_t right, std::size_t up) {
    const std::size_t index = (low + up) * static_cast<std::size_t>(columns_) + left + right;
    // The surface is half-way between a cell of the wall and a free one.
    return depths_[index] > 0.0F ? 0.5 * cell_ - depths_[index] : distances_[index] - 0.5 * cell_;
  };
  return (1.0 - v) * ((1.0 - u) * value(0, 0) + u * value(1, 0)) + v * ((1.0 - u) * value(0, 1) + u * value(1, 1));
}

std::vector<float> WallDistances::distances_from(const std::vector<std::uint8_t>& kinds, std::uint8_t kind) const {
  std::vector<float> distances(kinds.size(), static_cast<float>(kReach));
  const int reach = static_cast<int>(kReach / cell_);
  const auto kind_at = [&](int row, int column) { return kinds[static_cast<std::size_t>(row) * columns_ + column]; };
  for (int row = 0; row < rows_; ++row) {
    for (int column = 0; column < columns_; ++column) {
      if (kind_at(row, column) != kind) continue;
      const bool is_inside = row > 0 && column > 0 && row < rows_ - 1 && column < columns_ - 1 &&
                             kind_at(row - 1, column) == kind && kind_at(row + 1, column) == kind &&
                             kind_at(row, column - 1) == kind && kind_at(row, column + 1) == kind;
      const int spread = is_inside ? 0 : reach;  // others are nearer to the cells around it
      for (int y = std::max(0, row - spread); y <= std::min(rows_ - 1, row + spread); ++y) {
        for (int x = std::max(0, column - spread); x <= std::min(columns_ - 1, column + spread); ++x) {
          float& distance = distances[static_cast<std::size_t>(y) * columns_ + x];
          distance = std::min(distance, static_cast<float>(cell_ * std::hypot(x - column, y - row)));
        }
      }
    }
  }
  return distances;
}

}  // namespace byre
