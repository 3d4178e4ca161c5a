#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Positions sorted by the cells of a spatial grid, for fast neighbour search.
class PathCells {
 public:
  // reach: search radius, positive. Positions are fixed at construction.
  PathCells(const std::vector<Eigen::Vector3d>& places, double reach);

  // Indices of all positions within the reach, and of some beyond it, ascending.
  std::vector<std::uint32_t> near(const Eigen::Vector3d& place) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  struct Entry {
    Cell cell;
    std::uint32_t index = 0;
    auto operator<=>(const Entry&) const = default;
  };

  Cell cell_of(const Eigen::Vector3d& place) const;

  double size_;                 // edge of a cell
  std::vector<Entry> entries_;  // ascending
};

}  // namespace byre
