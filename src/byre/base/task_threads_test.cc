#include "byre/base/task_threads.h"

#include <atomic>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace byre {
namespace {

class TaskThreadsOf : public testing::TestWithParam<int> {};  // helpers

TEST_P(TaskThreadsOf, RunEachTaskOnce) {
  TaskThreads threads(GetParam());
  for (const int count : {0, 1, 2, 7, 100}) {
    for (int repetition = 0; repetition < 50; ++repetition) {
      std::vector<int> calls(static_cast<std::size_t>(count), 0);
      threads.run(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(calls, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
  }
}

TEST_P(TaskThreadsOf, ThrowTheExceptionOfATaskAndContinue) {
  TaskThreads threads(GetParam());
  EXPECT_THROW(threads.run(5,
                           [](int i) {
                             if (i == 2) throw std::runtime_error("task");
                           }),
               std::runtime_error);
  std::atomic<int> calls = 0;
  threads.run(5, [&](int) { ++calls; });
  EXPECT_EQ(calls, 5);
}

TEST_P(TaskThreadsOf, RunEachTaskOnceOnAShift) {
  TaskThreads threads(GetParam());
  for (int repetition = 0; repetition < 50; ++repetition) {
    const TaskThreads::SpinScope shift(threads);
    for (const int count : {1, 2, 30}) {
      std::vector<int> calls(static_cast<std::size_t>(count), 0);
      threads.run(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
      EXPECT_EQ(calls, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Helpers, TaskThreadsOf, testing::Values(0, 1, 3));

TEST(TaskThreads, RunConcurrently) {
  TaskThreads threads(1);
  std::atomic<int> waiting = 0;
  // Each task ends once the other has started, which never happens on one thread.
  threads.run(2, [&](int) {
    ++waiting;
    while (waiting < 2) std::this_thread::yield();
  });
  EXPECT_EQ(waiting, 2);
}

}  // namespace
}  // namespace byre
