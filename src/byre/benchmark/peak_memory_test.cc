#include "byre/benchmark/speed.h"

#include <cstring>

#include <gmock/gmock.h>
#include <sys/mman.h>

namespace byre {
namespace {

// mmap instead of the heap, because sanitizers delay the release of freed heap memory.
void use_for_a_moment(std::size_t bytes) {
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  std::memset(memory, 1, bytes);
  munmap(memory, bytes);
}

TEST(PeakMemory, CoversTheTimeSinceTheReset) {
  constexpr std::size_t kBytes = 200'000'000;
  constexpr double kMegabytes = 200.0;
  const double before = peak_memory_mb().value();
  use_for_a_moment(kBytes);
  const double with_large = peak_memory_mb().value();
  EXPECT_GT(with_large, kMegabytes);
  if (!reset_peak_memory()) GTEST_SKIP() << "the system does not allow resetting the peak";
  EXPECT_LT(peak_memory_mb().value(), with_large - 0.5 * kMegabytes);
  EXPECT_LT(peak_memory_mb().value(), before + 0.5 * kMegabytes);
}

}  // namespace
}  // namespace byre
