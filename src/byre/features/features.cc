#include "byre/features/features.h"

#include <numeric>
#include <utility>

namespace byre {
namespace {

template <typename Item>
std::vector<Item> in_order(std::vector<Item> items, const std::vector<int>& order) {
  if (items.empty()) return items;
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const int i : order) sorted.push_back(items[static_cast<std::size_t>(i)]);
  return sorted;
}

}  // namespace

Features::Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                   std::vector<Patch> patches)
    : columns_((width + kCellSize - 1) / kCellSize), rows_((height + kCellSize - 1) / kCellSize) {
  const auto cell_of = [&](const Keypoint& keypoint) {
    const int column = std::clamp(static_cast<int>(keypoint.pixel.x()) / kCellSize, 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(keypoint.pixel.y()) / kCellSize, 0, rows_ - 1);
    return row * columns_ + column;
  };
  // Counting sort by cell; stable, so equal input gives equal output.
  cell_begin_.assign(static_cast<std::size_t>(columns_ * rows_ + 1), 0);
  std::vector<int> cells;
  cells.reserve(keypoints.size());
  for (const Keypoint& keypoint : keypoints) {
    cells.push_back(cell_of(keypoint));
    ++cell_begin_[static_cast<std::size_t>(cells.back() + 1)];
  }
  std::partial_sum(cell_begin_.begin(), cell_begin_.end(), cell_begin_.begin());
  std::vector<int> next(cell_begin_.begin(), cell_begin_.end() - 1);
  std::vector<int> order(keypoints.size());
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    order[static_cast<std::size_t>(next[static_cast<std::size_t>(cells[i])]++)] = static_cast<int>(i);
  }
  keypoints_ = in_order(std::move(keypoints), order);
  descriptors_ = in_order(std::move(descriptors), order);
  patches_ = in_order(std::move(patches), order);
}

}  // namespace byre
