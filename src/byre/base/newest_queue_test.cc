#include "byre/base/newest_queue.h"

#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""s;
using testing::Eq;
using testing::Optional;

TEST(NewestQueue, DropsTheOldest) {
  NewestQueue<int> queue(2);
  for (int i = 0; i < 5; ++i) queue.put(i);
  EXPECT_EQ(queue.dropped(), 3);
  EXPECT_THAT(queue.take({}), Optional(3));
  EXPECT_THAT(queue.take({}), Optional(4));
  EXPECT_THAT(queue.take({}), Eq(std::nullopt));
}

TEST(NewestQueue, ReturnsTheRemainingItemsBeforeFailing) {
  NewestQueue<int> queue(2);
  queue.put(1);
  queue.fail(std::make_exception_ptr(std::runtime_error("no more")));
  EXPECT_THAT(queue.take({}), Optional(1));
  EXPECT_THROW(queue.take({}), std::runtime_error);
  EXPECT_THROW(queue.take({}), std::runtime_error);
}

TEST(NewestQueue, PassesAllItemsBetweenThreads) {
  constexpr int kItems = 1000;
  NewestQueue<int> queue(kItems);
  std::jthread filling([&] {
    for (int i = 0; i < kItems; ++i) queue.put(i);
  });
  for (int i = 0; i < kItems; ++i) ASSERT_THAT(queue.take(60s), Optional(i));
  EXPECT_EQ(queue.dropped(), 0);
}

}  // namespace
}  // namespace byre
