#include "byre/system/resources.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(ResourcesUsedSoFar, AreThoseOfAProgramThatRuns) {
  const ResourceUse resources = resources_used_so_far();
  EXPECT_GT(resources.cpu_seconds, 0.0);
  EXPECT_GT(resources.peak_memory_mb, 1.0);
}

TEST(ResidentMemory, IsNoMoreThanItEverWas) {
  const double now = resident_memory_mb();
  EXPECT_GT(now, 1.0);
  EXPECT_LE(now, 1.1 * resources_used_so_far().peak_memory_mb);
}

}  // namespace
}  // namespace byre
