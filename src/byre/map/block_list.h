#pragma once

#include <cstddef>
#include <vector>

namespace byre {

// List of fixed-size blocks. Growth moves no items, and only the last block has spare capacity.
template <typename Item>
class BlockList {
 public:
  BlockList() = default;
  explicit BlockList(std::size_t count) {
    while (size() < count) emplace_back();
  }

  std::size_t size() const { return blocks_.empty() ? 0 : (blocks_.size() - 1) * kBlock + blocks_.back().size(); }
  Item& operator[](std::size_t i) { return blocks_[i / kBlock][i % kBlock]; }
  const Item& operator[](std::size_t i) const { return blocks_[i / kBlock][i % kBlock]; }

  Item& emplace_back() {
    if (size() % kBlock == 0) blocks_.emplace_back();
    blocks_.back().reserve(kBlock);  // a copied block has no spare capacity
    return blocks_.back().emplace_back();
  }

 private:
  static constexpr std::size_t kBlock = 256;  // number of items

  std::vector<std::vector<Item>> blocks_;
};

}  // namespace byre
