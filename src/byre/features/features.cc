#include "byre/features/features.h"

#include <cmath>
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

// Pixels. Small cells make small searches, but there are never many more of them than keypoints.
int cell_size_for(int width, int height, std::size_t keypoints) {
  constexpr double kSmallest = 16.0;
  const double max_cells = 4.0 * static_cast<double>(keypoints) + 256.0;
  const double area = static_cast<double>(width) * static_cast<double>(height);
  return static_cast<int>(std::ceil(std::max(kSmallest, std::sqrt(area / max_cells))));
}

std::vector<int> one_each(std::size_t count) {
  std::vector<int> indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace

Features::Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                   std::vector<Patch> patches)
    : Features(width, height, std::move(keypoints), std::move(descriptors), std::move(patches), {}) {}

Features::Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                   std::vector<Patch> patches, std::vector<int> patch_of_keypoint)
    : patches_(std::move(patches)) {
  if (keypoints.empty()) return;
  cell_size_ = cell_size_for(width, height, keypoints.size());
  columns_ = (width + cell_size_ - 1) / cell_size_;
  rows_ = (height + cell_size_ - 1) / cell_size_;
  const auto cell_of = [&](const Keypoint& keypoint) {
    const int column = std::clamp(static_cast<int>(keypoint.pixel.x()) / cell_size_, 0, columns_ - 1);
    const int row = std::clamp(static_cast<int>(keypoint.pixel.y()) / cell_size_, 0, rows_ - 1);
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
  if (patch_of_keypoint.empty()) patch_of_keypoint = one_each(patches_.size());
  patch_of_keypoint_ = in_order(std::move(patch_of_keypoint), order);
}

}  // namespace byre
