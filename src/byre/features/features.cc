#include "byre/features.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numeric>
#include <utility>

namespace byre {
namespace {

template <typename Item>
std::vector<Item> in_order(std::vector<Item> items, const std::vector<int>& order) {
  if (items.empty() || std::ranges::is_sorted(order)) return items;
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

// Keypoints counted and sorted by the cells of a grid; stable, so equal input gives equal output.
struct Cells {
  int size = 0;  // pixels
  int columns = 0;
  int rows = 0;
  std::vector<int> begin;  // see Features::cell_begin_
  // Indices of keypoints. Memory of the thread, used again by the next that are sorted.
  std::vector<int>& order;

  Cells(int width, int height, const std::vector<Keypoint>& keypoints)
      : size(cell_size_for(width, height, keypoints.size())),
        columns((width + size - 1) / size),
        rows((height + size - 1) / size),
        begin(static_cast<std::size_t>(columns * rows + 1), 0),
        order(memory()[0]) {
    std::vector<int>& cells = memory()[1];
    std::vector<int>& next = memory()[2];
    order.resize(keypoints.size());
    cells.clear();
    for (const Keypoint& keypoint : keypoints) {
      cells.push_back(cell_of(keypoint));
      ++begin[static_cast<std::size_t>(cells.back() + 1)];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    next.assign(begin.begin(), begin.end() - 1);
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      order[static_cast<std::size_t>(next[static_cast<std::size_t>(cells[i])]++)] = static_cast<int>(i);
    }
  }

  static std::array<std::vector<int>, 3>& memory() {
    thread_local std::array<std::vector<int>, 3> kept;
    return kept;
  }

  int cell_of(const Keypoint& keypoint) const {
    const int column = std::clamp(static_cast<int>(keypoint.pixel.x()) / size, 0, columns - 1);
    const int row = std::clamp(static_cast<int>(keypoint.pixel.y()) / size, 0, rows - 1);
    return row * columns + column;
  }
};

}  // namespace

Features::Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                   std::vector<Patch> patches)
    : Features(width, height, std::move(keypoints), std::move(descriptors), std::move(patches), {}) {}

Features::Features(int width, int height, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors,
                   std::vector<Patch> patches, std::vector<int> patch_of_keypoint)
    : patches_(std::make_shared<const std::vector<Patch>>(std::move(patches))) {
  if (keypoints.empty()) return;
  Cells cells(width, height, keypoints);
  cell_size_ = cells.size;
  columns_ = cells.columns;
  rows_ = cells.rows;
  cell_begin_ = std::move(cells.begin);
  keypoints_ = in_order(std::move(keypoints), cells.order);
  descriptors_ = in_order(std::move(descriptors), cells.order);
  if (patch_of_keypoint.empty()) patch_of_keypoint = one_each(patches_->size());
  patch_of_keypoint_ = in_order(std::move(patch_of_keypoint), cells.order);
}

std::vector<int> Features::order_of(int width, int height, const std::vector<Keypoint>& keypoints) {
  return keypoints.empty() ? std::vector<int>{} : Cells(width, height, keypoints).order;
}

Features Features::moved(std::vector<Keypoint> keypoints) const {
  assert(keypoints.size() == keypoints_.size());
  Features result = *this;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    const float shift = (keypoints[i].pixel - keypoints_[i].pixel).cwiseAbs().maxCoeff();
    result.slack_ = std::max(result.slack_, slack_ + shift);
  }
  result.keypoints_ = std::move(keypoints);
  return result;
}

Features Features::with_patches_of(std::span<const int> features) const {
  std::vector<Patch> kept;
  kept.reserve(features.size());
  Features result = *this;
  result.patch_of_keypoint_.assign(keypoints_.size(), -1);
  for (const int i : features) {
    const Patch* const patch = find_patch(i);
    if (patch == nullptr) continue;
    result.patch_of_keypoint_[static_cast<std::size_t>(i)] = static_cast<int>(kept.size());
    kept.push_back(*patch);
  }
  result.patches_ = std::make_shared<const std::vector<Patch>>(std::move(kept));
  return result;
}

}  // namespace byre
