#pragma once

#include "byre/rig.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace byre {

// Grid of image regions, for quantities that vary over the image.
constexpr int kImageRegionColumns = 4;
constexpr int kImageRegionRows = 3;
constexpr int kImageRegions = kImageRegionColumns * kImageRegionRows;

// One value per region, row by row.
template <typename Value>
using ByImageRegion = std::array<Value, static_cast<std::size_t>(kImageRegions)>;

// The region of a pixel of the rig's image; the nearest region for pixels outside it.
inline std::size_t image_region_of(double u, double v, const Rig& rig) {
  const int column = std::clamp(static_cast<int>(kImageRegionColumns * u / rig.width), 0, kImageRegionColumns - 1);
  const int row = std::clamp(static_cast<int>(kImageRegionRows * v / rig.height), 0, kImageRegionRows - 1);
  return static_cast<std::size_t>(row * kImageRegionColumns + column);
}

}  // namespace byre
