#include "byre/base/worker.h"

#include <future>
#include <stdexcept>
#include <string>
#include <thread>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Text = Worker<std::string>;

std::optional<Text::Finished> collect_when_ready(Text& worker) {
  auto finished = worker.collect();
  while (!finished && !worker.idle()) {
    std::this_thread::yield();
    finished = worker.collect();
  }
  return finished;
}

struct WorkerExecutor {
  const char* name;
  std::unique_ptr<Executor> (*make)();
};

class WorkerOnEveryExecutor : public ::testing::TestWithParam<WorkerExecutor> {
 protected:
  Text worker_{GetParam().make()};
};

TEST_P(WorkerOnEveryExecutor, HasNoResultAtFirst) {
  EXPECT_TRUE(worker_.idle());
  EXPECT_FALSE(worker_.collect());
  EXPECT_FALSE(worker_.finish());
}

TEST_P(WorkerOnEveryExecutor, ReturnsEveryResultOnceAndInOrder) {
  for (const std::string text : {"one", "two", "three"}) {
    worker_.start([text] { return text; });
    EXPECT_FALSE(worker_.idle());
    const auto finished = collect_when_ready(worker_);
    ASSERT_TRUE(finished);
    EXPECT_EQ(finished->result, text);
    EXPECT_GE(finished->seconds, 0.0);
    EXPECT_TRUE(worker_.idle());
    EXPECT_FALSE(worker_.collect());
  }
}

TEST_P(WorkerOnEveryExecutor, FinishesTheRunningJob) {
  worker_.start([] { return std::string("last"); });
  const auto finished = worker_.finish();
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->result, "last");
  EXPECT_TRUE(worker_.idle());
}

TEST_P(WorkerOnEveryExecutor, ContinuesAfterAnException) {
  worker_.start([]() -> std::string { throw std::runtime_error("broken job"); });
  EXPECT_THROW(collect_when_ready(worker_), std::runtime_error);
  worker_.start([] { return std::string("whole"); });
  const auto finished = worker_.finish();
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->result, "whole");
}

INSTANTIATE_TEST_SUITE_P(Of, WorkerOnEveryExecutor,
                         ::testing::Values(WorkerExecutor{"Inline", [] { return make_inline_executor(); }},
                                           WorkerExecutor{"Paced", [] { return make_paced_executor(3); }},
                                           WorkerExecutor{"Live", [] { return make_live_executor(); }}),
                         [](const auto& tested) { return tested.param.name; });

TEST(Worker, ReturnsAResultInTheFrameOfThePacedExecutor) {
  Worker<int> worker(make_paced_executor(3));
  worker.start([] { return 7; });
  EXPECT_FALSE(worker.collect());
  EXPECT_FALSE(worker.collect());
  const auto finished = worker.collect();
  ASSERT_TRUE(finished);
  EXPECT_EQ(finished->result, 7);
}

TEST(Worker, DoesNotWaitForARunningLiveJob) {
  Worker<int> worker(make_live_executor());
  std::promise<void> may_end;
  worker.start([end = may_end.get_future().share()] {
    end.wait();
    return 9;
  });
  EXPECT_FALSE(worker.collect());
  EXPECT_FALSE(worker.idle());
  may_end.set_value();
  EXPECT_EQ(worker.finish()->result, 9);
}

// A result may itself be empty, such as that of an unsuccessful search.
TEST(Worker, DistinguishesAnEmptyResultFromNone) {
  Worker<std::optional<int>> worker(make_inline_executor());
  worker.start([] { return std::optional<int>(); });
  const auto finished = worker.collect();
  ASSERT_TRUE(finished);
  EXPECT_FALSE(finished->result);
  EXPECT_FALSE(worker.collect());
}

}  // namespace
}  // namespace byre
