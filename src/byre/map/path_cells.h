#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace byre {

// Places sorted by the cells of a grid in space, so that those near another one are found without looking at all.
class PathCells {
 public:
  // reach: how far what is looked for lies at most, positive. Places are those of the constructor from then on.
  PathCells(const std::vector<Eigen::Vector3d>& places, double reach);

  // All that lie within the reach, and some beyond it: indices of places, ascending.
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
