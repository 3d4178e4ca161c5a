#include "byre/map/plan/plan_walls.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>
#include <utility>

namespace byre {
namespace {

constexpr double kLeastCell = 0.1;  // metres

struct PlanBox {
  Eigen::Vector2d low;
  Eigen::Vector2d high;
};

PlanBox box_of_image(const FloorPlan& plan) {
  constexpr double kHalf = 0.5;
  PlanBox box{plan.point_at({-kHalf, -kHalf}), plan.point_at({-kHalf, -kHalf})};
  for (const double column : {-kHalf, plan.width - kHalf}) {
    for (const double row : {-kHalf, plan.height - kHalf}) {
      box.low = box.low.cwiseMin(plan.point_at({column, row}));
      box.high = box.high.cwiseMax(plan.point_at({column, row}));
    }
  }
  return box;
}

constexpr std::array<std::pair<int, int>, 8> kNeighbours = {
    {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {1, -1}, {-1, 1}, {-1, -1}}};

}  // namespace

PlanWalls::PlanWalls(const FloorPlan& plan, std::span<const std::int8_t> occupancy) {
  assert(occupancy.size() == static_cast<std::size_t>(plan.width) * static_cast<std::size_t>(plan.height));
  // Adjacent pixels of a line are at most a diagonal apart, so that no cell between them stays free.
  cell_ = std::max(kLeastCell, plan.metres_per_pixel.colwise().norm().maxCoeff() * std::numbers::sqrt2);
  const PlanBox box = box_of_image(plan);
  corner_in_plan_ = box.low.array() - cell_;  // leaves a border of free cells around the image
  const Eigen::Vector2d size = (box.high - box.low) / cell_;
  columns_ = static_cast<int>(std::ceil(size.x())) + 2;
  rows_ = static_cast<int>(std::ceil(size.y())) + 2;
  is_wall_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), 0);
  is_reached_.assign(is_wall_.size(), 0);
  std::size_t pixel = 0;
  for (int row = 0; row < plan.height; ++row) {
    for (int column = 0; column < plan.width; ++column) {
      if (occupancy[pixel++] == kOccupiedPixel) is_wall_[index(cell_at(plan.point_at({column, row})))] = 1;
    }
  }
}

PlanWalls::Cell PlanWalls::cell_at(const Eigen::Vector2d& point_in_plan) const {
  const Eigen::Vector2d place = (point_in_plan - corner_in_plan_) / cell_;
  return {static_cast<int>(std::clamp(std::floor(place.x()), 0.0, columns_ - 1.0)),
          static_cast<int>(std::clamp(std::floor(place.y()), 0.0, rows_ - 1.0))};
}

bool PlanWalls::is_inside(Cell cell) const {
  return cell.column >= 0 && cell.row >= 0 && cell.column < columns_ && cell.row < rows_;
}

// A diagonal step requires that both adjacent cells are free.
bool PlanWalls::can_step(Cell from, int right, int down) const {
  const Cell to{from.column + right, from.row + down};
  if (!is_inside(to) || is_wall(to)) return false;
  if (right == 0 || down == 0) return true;
  return !is_wall({to.column, from.row}) && !is_wall({from.column, to.row});
}

template <typename Accept>
bool PlanWalls::any_in(const PlanDisc& disc, const Accept& accept) const {
  const Cell middle = cell_at(disc.centre);
  const int reach = static_cast<int>(disc.radius / cell_);
  for (int down = -reach; down <= reach; ++down) {
    for (int right = -reach; right <= reach; ++right) {
      if (right * right + down * down > reach * reach) continue;
      const Cell cell{middle.column + right, middle.row + down};
      if (is_inside(cell) && accept(cell)) return true;
    }
  }
  return false;
}

bool PlanWalls::has_free_cell(const PlanDisc& disc) const {
  return any_in(disc, [this](Cell cell) { return !is_wall(cell); });
}

bool PlanWalls::has_reachable_cell(const PlanDisc& disc) const {
  return any_in(disc, [this](Cell cell) { return is_reached_[index(cell)] != 0; });
}

void PlanWalls::clear_along_paths(std::span<const std::vector<Eigen::Vector2d>> paths_in_plan) {
  std::vector<Cell> driven;
  for (const std::vector<Eigen::Vector2d>& way : paths_in_plan) {
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Eigen::Vector2d& from = way[i > 0 ? i - 1 : 0];
      const int pieces = 1 + static_cast<int>(2.0 * (way[i] - from).norm() / cell_);
      for (int piece = 0; piece <= pieces; ++piece) {
        const double share = static_cast<double>(piece) / pieces;
        driven.push_back(cell_at((1.0 - share) * from + share * way[i]));
      }
    }
  }
  for (const Cell cell : driven) {
    for (int down = -1; down <= 1; ++down) {
      for (int right = -1; right <= 1; ++right) {
        const Cell beside{cell.column + right, cell.row + down};
        if (is_inside(beside)) is_wall_[index(beside)] = 0;
      }
    }
  }
  flood(std::move(driven));
}

void PlanWalls::flood(std::vector<Cell> front) {
  for (const Cell cell : front) is_reached_[index(cell)] = 1;
  while (!front.empty()) {
    const Cell from = front.back();
    front.pop_back();
    for (const auto& [right, down] : kNeighbours) {
      const Cell to{from.column + right, from.row + down};
      if (!can_step(from, right, down) || is_reached_[index(to)] != 0) continue;
      is_reached_[index(to)] = 1;
      front.push_back(to);
    }
  }
}

// Dijkstra's algorithm from all free cells of the start disc, in the part of the grid that `longest` allows.
std::optional<double> PlanWalls::path_length_between(const PlanDisc& start, const PlanDisc& end, double longest) const {
  const double reach = start.radius + longest + 2.0 * cell_;
  const Cell low = cell_at(start.centre.array() - reach), high = cell_at(start.centre.array() + reach);
  const int width = high.column - low.column + 1;
  const auto place = [&](Cell cell) {
    return static_cast<std::size_t>(cell.row - low.row) * static_cast<std::size_t>(width) +
           static_cast<std::size_t>(cell.column - low.column);
  };
  std::vector<float> length(place(high) + 1, std::numeric_limits<float>::infinity());
  using Step = std::pair<float, std::pair<int, int>>;  // path length in metres, then column and row
  std::priority_queue<Step, std::vector<Step>, std::greater<>> steps;
  any_in(start, [&](Cell cell) {
    if (!is_wall(cell)) {
      length[place(cell)] = 0.0f;
      steps.emplace(0.0f, std::pair(cell.column, cell.row));
    }
    return false;
  });
  const Cell goal = cell_at(end.centre);
  const int goal_reach = static_cast<int>(end.radius / cell_);
  while (!steps.empty()) {
    const auto [so_far, at] = steps.top();
    steps.pop();
    const Cell from{at.first, at.second};
    if (so_far > length[place(from)]) continue;
    const int right_of = from.column - goal.column, below = from.row - goal.row;
    if (right_of * right_of + below * below <= goal_reach * goal_reach) return so_far;
    for (const auto& [right, down] : kNeighbours) {
      const Cell to{from.column + right, from.row + down};
      if (!can_step(from, right, down)) continue;
      const float further = so_far + static_cast<float>(cell_ * std::hypot(right, down));
      const bool is_in_window =
          to.column >= low.column && to.row >= low.row && to.column <= high.column && to.row <= high.row;
      if (!is_in_window || further > longest || further >= length[place(to)]) continue;
      length[place(to)] = further;
      steps.emplace(further, std::pair(to.column, to.row));
    }
  }
  return std::nullopt;
}

}  // namespace byre
