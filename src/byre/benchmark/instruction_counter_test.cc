#include "byre/benchmark/speed.h"

#include <atomic>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

void execute(std::uint64_t instructions) {
  std::atomic<std::uint64_t> done = 0;
  while (done < instructions) ++done;
}

TEST(InstructionCounter, CountsInstructionsOfItsThreadAndLaterThreads) {
  constexpr std::uint64_t kMany = 1'000'000;
  const InstructionCounter counter;
  if (!counter.count()) GTEST_SKIP() << "instruction counts are not available";
  const std::uint64_t before = *counter.count();
  execute(kMany);
  const std::uint64_t own = *counter.count() - before;
  EXPECT_GE(own, kMany);
  std::thread([] { execute(kMany); }).join();
  EXPECT_GE(*counter.count() - before - own, kMany);
}

}  // namespace
}  // namespace byre
