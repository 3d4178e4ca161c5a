#pragma once

#include "byre/base/shared.h"

#include <cstddef>
#include <vector>

namespace byre {

// List of fixed-size blocks. Copies share a block until one of them changes it. Growth moves no items, and only the
// last block has spare capacity.
template <typename Item>
class BlockList {
 public:
  BlockList() = default;
  explicit BlockList(std::size_t count) {
    while (size() < count) emplace_back();
  }

  std::size_t size() const { return blocks_.empty() ? 0 : (blocks_.size() - 1) * kBlock + blocks_.back()->size(); }
  const Item& operator[](std::size_t i) const { return blocks_[i / kBlock].given()[i % kBlock]; }
  // The item, to change it. References to items of its block are invalid afterwards if a copy shares the block.
  Item& edit(std::size_t i) { return blocks_[i / kBlock].edit()[i % kBlock]; }

  Item& emplace_back() {
    if (size() % kBlock == 0) blocks_.emplace_back();
    std::vector<Item>& last = blocks_.back().edit();
    last.reserve(kBlock);  // a copied block has no spare capacity
    return last.emplace_back();
  }

 private:
  static constexpr std::size_t kBlock = 256;  // number of items

  std::vector<Shared<std::vector<Item>>> blocks_;
};

}  // namespace byre
