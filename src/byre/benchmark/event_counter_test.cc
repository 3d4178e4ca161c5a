#include "byre/benchmark/event_counter.h"

#include <cstring>
#include <thread>

#include <gmock/gmock.h>
#include <sys/mman.h>
#include <unistd.h>

namespace byre {
namespace {

void touch_pages(std::size_t pages) {
  const std::size_t bytes = pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  void* const memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  ASSERT_NE(memory, MAP_FAILED);
  madvise(memory, bytes, MADV_NOHUGEPAGE);
  std::memset(memory, 1, bytes);
  munmap(memory, bytes);
}

TEST(EventCounter, CountsEventsOfItsThreadAndLaterThreads) {
  constexpr std::size_t kPages = 1000;
  const EventCounter counter(EventCounter::Event::page_faults);
  if (!counter.count()) GTEST_SKIP() << "event counters are not available";
  const std::uint64_t before = *counter.count();
  touch_pages(kPages);
  const std::uint64_t own = *counter.count() - before;
  EXPECT_GE(own, kPages);
  std::thread([] { touch_pages(kPages); }).join();
  EXPECT_GE(*counter.count() - before - own, kPages);
}

}  // namespace
}  // namespace byre
