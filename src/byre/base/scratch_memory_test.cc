#include "byre/base/scratch_memory.h"

#include <cstddef>
#include <numeric>
#include <thread>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;

TEST(ReusedMemory, IsReused) {
  void* const first = allocate_scratch(1000);
  free_scratch(first, 1000);
  EXPECT_EQ(allocate_scratch(900), first) << "blocks of similar size share a free list";
  void* const second = allocate_scratch(1000);
  EXPECT_NE(second, first) << "it is in use";
  free_scratch(first, 900);
  free_scratch(second, 1000);
}

TEST(ReusedMemory, HasAtLeastTheRequestedSize) {
  constexpr std::size_t kMost = 3 << 20;
  for (std::size_t bytes = 1; bytes < kMost; bytes = bytes * 3 + 1) {
    free_scratch(allocate_scratch(bytes), bytes);
    ScratchVector<std::byte> filled(bytes + 1, std::byte{7});  // sanitizers report a block that is too small
    EXPECT_THAT(std::vector(filled.end() - 1, filled.end()), Each(std::byte{7})) << bytes;
  }
}

TEST(ReusedMemory, BacksListsThatMoveBetweenThreads) {
  ScratchVector<int> made;
  std::thread([&] {
    ScratchVector<int> numbers(5000);
    std::iota(numbers.begin(), numbers.end(), 0);
    made = std::move(numbers);
  }).join();
  const ScratchVector<int> copy = made;
  std::thread([gone = std::move(made)]() mutable { gone = {}; }).join();
  EXPECT_EQ(copy.size(), 5000U);
  EXPECT_EQ(std::accumulate(copy.begin(), copy.end(), 0), 4999 * 5000 / 2);
}

TEST(ReusedMemory, BacksListsThatOutliveItsStore) {
  std::thread([] {
    thread_local ScratchVector<int> outlives;  // constructed before the store, hence destroyed after it
    outlives.assign(1000, 1);
    EXPECT_EQ(outlives.size(), 1000U);
  }).join();
}

}  // namespace
}  // namespace byre
