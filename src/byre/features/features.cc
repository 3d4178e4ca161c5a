#include "byre/features.h"

#include "byre/base/scratch_memory.h"

#include <cassert>
#include <numeric>

namespace byre {
namespace {

template <typename Item>
std::vector<Item> reordered(std::vector<Item> items, std::span<const int> order) {
  if (items.empty() || std::ranges::is_sorted(order)) return items;
  std::vector<Item> sorted;
  sorted.reserve(items.size());
  for (const int i : order) sorted.push_back(items[static_cast<std::size_t>(i)]);
  return sorted;
}

// Cell size in pixels. Small cells make searches cheap; the number of cells stays proportional to that of keypoints.
int cell_size_for(int width, int height, std::size_t keypoints) {
  constexpr double kSmallest = 16.0;
  const double max_cells = 4.0 * static_cast<double>(keypoints) + 256.0;
  const double area = static_cast<double>(width) * static_cast<double>(height);
  return static_cast<int>(std::ceil(std::max(kSmallest, std::sqrt(area / max_cells))));
}

std::vector<int> identity_order(std::size_t count) {
  std::vector<int> indices(count);
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

// Same, in the memory of the resulting vector.
template <typename Item>
void reorder_into(const std::vector<Item>& items, std::span<const int> order, std::vector<Item>& sorted) {
  sorted.clear();
  sorted.reserve(items.size());
  for (const int i : order) sorted.push_back(items[static_cast<std::size_t>(i)]);
}

// Keypoints counted and sorted by the cells of a grid; stable, therefore deterministic.
struct Cells {
  int size = 0;  // pixels
  int columns = 0;
  int rows = 0;
  ScratchVector<int> order;  // indices of keypoints

  // begin becomes Features::cell_begin_, and keeps its memory.
  Cells(int width, int height, const std::vector<Keypoint>& keypoints, std::vector<int>& begin)
      : size(cell_size_for(width, height, keypoints.size())),
        columns((width + size - 1) / size),
        rows((height + size - 1) / size),
        order(keypoints.size()) {
    begin.assign(static_cast<std::size_t>(columns * rows + 1), 0);
    ScratchVector<int> cells;
    cells.reserve(keypoints.size());
    for (const Keypoint& keypoint : keypoints) {
      cells.push_back(cell_of(keypoint));
      ++begin[static_cast<std::size_t>(cells.back() + 1)];
    }
    std::partial_sum(begin.begin(), begin.end(), begin.begin());
    ScratchVector<int> next(begin.begin(), begin.end() - 1);
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      order[static_cast<std::size_t>(next[static_cast<std::size_t>(cells[i])]++)] = static_cast<int>(i);
    }
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
                   std::vector<Patch> patches, std::vector<int> patch_of_keypoint) {
  set_patches(std::make_shared<const std::vector<Patch>>(std::move(patches)));
  if (keypoints.empty()) return;
  std::vector<int> cell_begin;
  const Cells cells(width, height, keypoints, cell_begin);
  cell_size_ = cells.size;
  columns_ = cells.columns;
  rows_ = cells.rows;
  cell_begin_.take(std::move(cell_begin));
  keypoints_.take(reordered(std::move(keypoints), cells.order));
  descriptors_.take(reordered(std::move(descriptors), cells.order));
  if (patch_of_keypoint.empty()) patch_of_keypoint = identity_order(patches_.view().size());
  patch_of_keypoint_.take(reordered(std::move(patch_of_keypoint), cells.order));
}

void Features::refill(int width, int height, const std::vector<Keypoint>& keypoints,
                      const std::vector<Descriptor>& descriptors,
                      const std::shared_ptr<const std::vector<Patch>>& patches) {
  set_patches(patches);
  slack_ = 0.0f;
  ScratchVector<int> order;
  cell_begin_.refill([&](std::vector<int>& begin) {
    Cells cells(width, height, keypoints, begin);
    cell_size_ = cells.size;
    columns_ = keypoints.empty() ? 0 : cells.columns;
    rows_ = keypoints.empty() ? 0 : cells.rows;
    order = std::move(cells.order);
  });
  keypoints_.refill([&](std::vector<Keypoint>& sorted) { reorder_into(keypoints, order, sorted); });
  descriptors_.refill([&](std::vector<Descriptor>& sorted) { reorder_into(descriptors, order, sorted); });
  patch_of_keypoint_.refill([&](std::vector<int>& patch_of_keypoint) {
    patch_of_keypoint.clear();
    if (!patches_.view().empty()) patch_of_keypoint.assign(order.begin(), order.end());
  });
}

std::vector<int> Features::order_of(int width, int height, const std::vector<Keypoint>& keypoints) {
  if (keypoints.empty()) return {};
  std::vector<int> begin;
  const ScratchVector<int> order = Cells(width, height, keypoints, begin).order;
  return {order.begin(), order.end()};
}

Features Features::moved(std::vector<Keypoint> keypoints) const {
  assert(static_cast<int>(keypoints.size()) == size());
  Features result = *this;
  result.update_slack(keypoints);
  result.keypoints_.take(std::move(keypoints));
  return result;
}

void Features::refill_moved(const Features& features, std::span<const Keypoint> keypoints) {
  assert(static_cast<int>(keypoints.size()) == features.size());
  *this = features;
  update_slack(keypoints);
  keypoints_.refill([&](std::vector<Keypoint>& own) { own.assign(keypoints.begin(), keypoints.end()); });
}

void Features::update_slack(std::span<const Keypoint> keypoints) {
  float farthest = 0.0f;
  for (std::size_t i = 0; i < keypoints.size(); ++i) {
    farthest = std::max(farthest, (keypoints[i].pixel - this->keypoints()[i].pixel).cwiseAbs().maxCoeff());
  }
  slack_ += farthest;
}

Features Features::with_patches_of(std::span<const int> features) const {
  std::vector<int> patch_of_keypoint(static_cast<std::size_t>(size()), -1);
  std::vector<Patch> kept;
  kept.reserve(features.size());
  for (const int i : features) {
    const Patch* const patch = find_patch(i);
    if (patch == nullptr) continue;
    patch_of_keypoint[static_cast<std::size_t>(i)] = static_cast<int>(kept.size());
    kept.push_back(*patch);
  }
  if (kept.empty()) patch_of_keypoint = {};
  Features result = *this;
  result.patch_of_keypoint_.take(std::move(patch_of_keypoint));
  result.set_patches(std::make_shared<const std::vector<Patch>>(std::move(kept)));
  return result;
}

// Lists that are accessed together come first.
std::array<std::span<const std::byte>, Features::kArrays> Features::arrays() const {
  return {std::as_bytes(keypoints()), std::as_bytes(patch_of_keypoint_.view()), std::as_bytes(cell_begin_.view()),
          std::as_bytes(descriptors()), std::as_bytes(patches())};
}

Features Features::with_arrays_at(const std::array<std::shared_ptr<const std::byte>, kArrays>& places) const {
  Features result;
  result.cell_size_ = cell_size_;
  result.columns_ = columns_;
  result.rows_ = rows_;
  result.slack_ = slack_;
  result.keypoints_ = keypoints_.at(places[0]);
  result.patch_of_keypoint_ = patch_of_keypoint_.at(places[1]);
  result.cell_begin_ = cell_begin_.at(places[2]);
  result.descriptors_ = descriptors_.at(places[3]);
  result.patches_ = patches_.at(places[4]);
  return result;
}

void Features::set_patches(const std::shared_ptr<const std::vector<Patch>>& patches) {
  patches_ = Items<Patch>(std::shared_ptr<const Patch>(patches, patches->data()), patches->size());
}

}  // namespace byre
