#include "byre/cli/benchmark_memory.h"

#include <vector>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

TEST(PeakMemory, IsOfWhatCameSinceTheReset) {
  constexpr std::size_t kBytes = 200'000'000;
  constexpr double kMegabytes = 200.0;
  const double before = peak_memory_mb().value();
  { const std::vector<char> large(kBytes, 1); }
  const double with_large = peak_memory_mb().value();
  EXPECT_GT(with_large, kMegabytes);
  if (!reset_peak_memory()) GTEST_SKIP() << "the system lets no program reset its peak";
  EXPECT_LT(peak_memory_mb().value(), with_large - 0.5 * kMegabytes);
  EXPECT_LT(peak_memory_mb().value(), before + 0.5 * kMegabytes);
}

}  // namespace
}  // namespace byre::cli
