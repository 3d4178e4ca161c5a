#include "byre/base/lazy_array.h"

#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

TEST(MadeOnceTest, IsCreatedOnFirstAccess) {
  int made = 0;
  const LazyArray<std::string> things(3);
  const auto make = [&made] { return std::to_string(++made); };
  EXPECT_EQ(things.get(2, make), "1");
  EXPECT_EQ(things.get(0, make), "2");
  EXPECT_EQ(&things.get(2, make), &things.get(2, make));
  EXPECT_EQ(made, 2);
}

TEST(MadeOnceTest, IsCreatedAgainAfterAFailure) {
  const LazyArray<int> things(1);
  EXPECT_THROW(things.get(0, []() -> int { throw std::runtime_error("not now"); }), std::runtime_error);
  EXPECT_EQ(things.get(0, [] { return 7; }), 7);
}

TEST(MadeOnceTest, ReturnsTheSameToAllThreads) {
  constexpr std::size_t kThings = 1000;
  const LazyArray<std::vector<std::size_t>> things(kThings);
  std::vector<std::vector<const std::vector<std::size_t>*>> seen(4);
  std::vector<std::jthread> threads;
  for (auto& seen_by_thread : seen) {
    threads.emplace_back([&] {
      for (std::size_t i = 0; i < kThings; ++i) {
        seen_by_thread.push_back(&things.get(i, [i] { return std::vector<std::size_t>(3, i); }));
        if (seen_by_thread.back()->back() != i) return;
      }
    });
  }
  threads.clear();
  EXPECT_THAT(seen, testing::Each(testing::Eq(seen.front())));
  EXPECT_EQ(seen.front().size(), kThings);
}

}  // namespace
}  // namespace byre
