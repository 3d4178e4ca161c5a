#include "byre/slam/system/resources.h"

#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(ResourceUsage, ArePositive) {
  const ResourceUsage resources = resource_usage();
  EXPECT_GT(resources.cpu_seconds, 0.0);
  EXPECT_GT(resources.peak_memory_mb, 1.0);
}

TEST(ResidentMemory, IsAtMostThePeak) {
  const double now = resident_memory_mb();
  EXPECT_GT(now, 1.0);
  EXPECT_LE(now, 1.1 * resource_usage().peak_memory_mb);
}

#ifndef BYRE_SANITIZED  // sanitizers keep freed memory
TEST(ReleaseFreeMemory, ReducesResidentMemory) {
  std::vector<std::vector<char>> blocks;
  for (int i = 0; i < 40000; ++i) blocks.emplace_back(1000, 'x');  // small blocks: on the heap
  const std::vector<char> last(1000, 'y');                         // keeps the end of the heap in use
  const double before = resident_memory_mb();
  blocks.clear();
  release_free_memory();
  EXPECT_LT(resident_memory_mb(), before - 20.0);
  EXPECT_EQ(last.front(), 'y');
}
#endif

}  // namespace
}  // namespace byre
