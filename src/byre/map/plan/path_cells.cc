#include "byre/map/plan/path_cells.h"

#include <algorithm>
#include <cmath>

namespace byre {

PathCells::PathCells(const std::vector<Eigen::Vector3d>& places, double reach) : size_(reach) {
  entries_.reserve(places.size());
  for (std::uint32_t i = 0; i < places.size(); ++i) entries_.push_back({cell_of(places[i]), i});
  std::ranges::sort(entries_);
}

// Cells have the size of the reach, so that neighbours are in adjacent cells. Cells of a column are contiguous.
std::vector<std::uint32_t> PathCells::near(const Eigen::Vector3d& place) const {
  std::vector<std::uint32_t> indices;
  const Cell own = cell_of(place);
  for (std::int64_t x = own[0] - 1; x <= own[0] + 1; ++x) {
    for (std::int64_t y = own[1] - 1; y <= own[1] + 1; ++y) {
      const auto first = std::ranges::lower_bound(entries_, Cell{x, y, own[2] - 1}, {}, &Entry::cell);
      const auto last = std::ranges::upper_bound(first, entries_.end(), Cell{x, y, own[2] + 1}, {}, &Entry::cell);
      for (auto entry = first; entry != last; ++entry) indices.push_back(entry->index);
    }
  }
  std::ranges::sort(indices);
  return indices;
}

// Positions beyond kFarthest or not a number are clamped.
PathCells::Cell PathCells::cell_of(const Eigen::Vector3d& place) const {
  constexpr double kFarthest = 1e9;  // cells
  Cell cell;
  for (int axis = 0; axis < 3; ++axis) {
    const double along = std::floor(place[axis] / size_);
    cell[static_cast<std::size_t>(axis)] = along > -kFarthest ? static_cast<std::int64_t>(std::min(along, kFarthest))
                                                              : static_cast<std::int64_t>(-kFarthest);
  }
  return cell;
}

}  // namespace byre
