#include "byre/map/block_list.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr int kMany = 1000;  // several blocks, the last one not full

BlockList<int> counted() {
  BlockList<int> list;
  for (int i = 0; i < kMany; ++i) list.emplace_back() = i;
  return list;
}

TEST(BlockList, ReturnsAddedElements) {
  const BlockList<int> list = counted();
  ASSERT_EQ(list.size(), static_cast<std::size_t>(kMany));
  for (int i = 0; i < kMany; ++i) EXPECT_EQ(list[static_cast<std::size_t>(i)], i);
}

TEST(BlockList, KeepsAddressesWhenItGrows) {
  BlockList<int> list;
  const int* const first = &list.emplace_back();
  for (int i = 0; i < kMany; ++i) list.emplace_back();
  EXPECT_EQ(&list[0], first);
}

TEST(BlockList, IsCopyable) {
  const BlockList<int> list = counted();
  BlockList<int> copy = list;
  copy.emplace_back() = -1;
  copy.edit(0) = -2;
  EXPECT_EQ(list.size(), static_cast<std::size_t>(kMany));
  EXPECT_EQ(list[0], 0);
  EXPECT_EQ(copy[kMany], -1);
  EXPECT_EQ(copy[kMany - 1], kMany - 1);
}

TEST(BlockList, SharesBlocksThatNoCopyChanged) {
  const BlockList<int> list = counted();
  BlockList<int> copy = list;
  copy.edit(kMany - 1) = -1;
  EXPECT_EQ(&copy[0], &list[0]);
  EXPECT_NE(&copy[kMany - 1], &list[kMany - 1]);
}

TEST(BlockList, StartsWithTheGivenSize) {
  EXPECT_EQ(BlockList<int>(0).size(), 0u);
  const BlockList<int> list(300);
  EXPECT_EQ(list.size(), 300u);
  EXPECT_EQ(list[299], 0);
}

}  // namespace
}  // namespace byre
