#include "byre/base/serial_queue.h"

#include <future>
#include <latch>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::ElementsAre;

TEST(SerialQueue, RunsTasksOfAllThreadsInOrder) {
  constexpr int kTasks = 1000;
  SerialQueue queue;
  std::vector<int> done;  // unguarded: tasks do not overlap
  for (int i = 0; i < kTasks; ++i) {
    const auto task = [&done, i] { done.push_back(i); };
    switch (i % 3) {
      case 0:
        queue.add(task);
        break;
      case 1:
        queue.submit(task);
        break;
      default:
        queue.run(task);
    }
  }
  queue.run([&] {
    ASSERT_EQ(done.size(), kTasks);
    for (int i = 0; i < kTasks; ++i) EXPECT_EQ(done[static_cast<std::size_t>(i)], i);
  });
}

TEST(SerialQueue, RunsOnTheCallersThreadWithoutSubmittedTasks) {
  SerialQueue queue;
  std::thread::id thread;
  queue.add([&] { thread = std::this_thread::get_id(); });
  EXPECT_EQ(thread, std::this_thread::get_id());
  EXPECT_EQ(queue.run([] { return 7; }), 7);
}

TEST(SerialQueue, ExcludesCallersFromEachOther) {
  SerialQueue queue;
  int sum = 0;  // unguarded
  {
    std::vector<std::jthread> callers(4);
    for (std::jthread& caller : callers) {
      caller = std::jthread([&] {
        for (int i = 0; i < 1000; ++i) queue.run([&] { ++sum; });
      });
    }
  }
  EXPECT_EQ(sum, 4000);
}

TEST(SerialQueue, ReplacesTheOldestWaitingTasks) {
  SerialQueue queue;
  std::vector<int> done;
  std::latch is_full{1};
  queue.submit([&] { is_full.wait(); });
  for (int i = 1; i <= 4; ++i) {
    queue.submit([&done, i] { done.push_back(i); }, [&done, i] { done.push_back(-i); }, 2);
    queue.submit([&done, i] { done.push_back(10 * i); });
  }
  is_full.count_down();
  queue.run([&] { EXPECT_THAT(done, ElementsAre(-1, 10, -2, 20, 3, 30, 4, 40)); });
}

TEST(SerialQueue, RunsTasksWithinTasks) {
  SerialQueue queue;
  std::promise<int> result;
  queue.submit([&] { result.set_value(queue.run([&] { return queue.run([] { return 1; }) + 1; })); });
  EXPECT_EQ(result.get_future().get(), 2);
}

TEST(SerialQueue, KeepsTheFirstExceptionAndContinues) {
  SerialQueue queue;
  for (const char* const text : {"first", "second"}) queue.submit([text] { throw std::runtime_error(text); });
  EXPECT_EQ(queue.run([] { return 3; }), 3);
  EXPECT_THROW(
      {
        try {
          queue.rethrow_failure();
        } catch (const std::runtime_error& error) {
          EXPECT_STREQ(error.what(), "first");
          throw;
        }
      },
      std::runtime_error);
  EXPECT_NO_THROW(queue.rethrow_failure());
  EXPECT_THROW(queue.run([] { throw std::logic_error("of the caller"); }), std::logic_error);
  EXPECT_EQ(queue.run([] { return 4; }), 4);
}

TEST(SerialQueue, MayEndWithinATaskAndDiscardsTheOthers) {
  auto queue = std::make_unique<SerialQueue>();
  bool was_run = false;
  std::latch is_full{1};
  const auto ended = std::make_shared<std::promise<void>>();
  queue->submit([&, ended] {
    is_full.wait();
    queue.reset();
    ended->set_value();
  });
  queue->submit([&] { was_run = true; });
  is_full.count_down();
  ended->get_future().wait();
  EXPECT_FALSE(was_run);
}

}  // namespace
}  // namespace byre
