#include "byre/base/executor.h"

#include <atomic>
#include <future>
#include <memory>
#include <stdexcept>
#include <thread>
#include <utility>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

namespace byre {
namespace {

int number_of(const std::optional<FinishedJob>& finished) {
  return std::any_cast<int>(finished->result);
}

std::any break_off() {
  throw std::runtime_error("broken job");
}

// Polls once per "frame" until the job is done.
std::optional<FinishedJob> collect_when_ready(Executor& executor) {
  auto finished = executor.collect();
  while (!finished && !executor.idle()) {
    std::this_thread::yield();
    finished = executor.collect();
  }
  return finished;
}

struct NamedExecutor {
  const char* name;
  std::unique_ptr<Executor> (*make)();
};

class EveryExecutor : public ::testing::TestWithParam<NamedExecutor> {
 protected:
  const std::unique_ptr<Executor> executor_ = GetParam().make();
};

TEST_P(EveryExecutor, HasNoResultAtFirst) {
  EXPECT_TRUE(executor_->idle());
  EXPECT_FALSE(executor_->collect());
  EXPECT_FALSE(executor_->finish());
}

TEST_P(EveryExecutor, ReturnsEveryResultOnceAndInOrder) {
  for (int job = 0; job < 5; ++job) {
    executor_->submit([job] { return job; });
    EXPECT_FALSE(executor_->idle());
    const auto finished = collect_when_ready(*executor_);
    ASSERT_TRUE(finished);
    EXPECT_EQ(number_of(finished), job);
    EXPECT_GE(finished->seconds, 0.0);
    EXPECT_TRUE(executor_->idle());
    EXPECT_FALSE(executor_->collect());
  }
}

TEST_P(EveryExecutor, FinishesTheRunningJob) {
  executor_->submit([] { return 7; });
  const auto finished = executor_->finish();
  ASSERT_TRUE(finished);
  EXPECT_EQ(number_of(finished), 7);
  EXPECT_TRUE(executor_->idle());
  EXPECT_FALSE(executor_->finish());
}

TEST_P(EveryExecutor, ThrowsTheExceptionOfAJobInPlaceOfItsResult) {
  executor_->submit(break_off);
  EXPECT_THROW(collect_when_ready(*executor_), std::runtime_error);
  EXPECT_TRUE(executor_->idle());
  executor_->submit(break_off);
  EXPECT_THROW(executor_->finish(), std::runtime_error);
  EXPECT_TRUE(executor_->idle());
}

TEST_P(EveryExecutor, ContinuesAfterAnException) {
  executor_->submit(break_off);
  EXPECT_THROW(executor_->finish(), std::runtime_error);
  executor_->submit([] { return 3; });
  EXPECT_EQ(number_of(executor_->finish()), 3);
}

TEST_P(EveryExecutor, FinishesItsJobBeforeDestruction) {
  std::atomic<bool> done = false;
  auto executor = GetParam().make();
  executor->submit([&done] {
    done = true;
    return std::any();
  });
  executor.reset();
  EXPECT_TRUE(done);
}

INSTANTIATE_TEST_SUITE_P(Of, EveryExecutor,
                         ::testing::Values(NamedExecutor{"Inline", [] { return make_inline_executor(); }},
                                           NamedExecutor{"PacedOne", [] { return make_paced_executor(1); }},
                                           NamedExecutor{"PacedThree", [] { return make_paced_executor(3); }},
                                           NamedExecutor{"Live", [] { return make_live_executor(); }}),
                         [](const auto& tested) { return tested.param.name; });

TEST(InlineExecutor, RunsTheJobOnTheCallingThreadBeforeSubmitReturns) {
  const auto executor = make_inline_executor();
  std::thread::id ran_on;
  executor->submit([&ran_on] {
    ran_on = std::this_thread::get_id();
    return std::any();
  });
  EXPECT_EQ(ran_on, std::this_thread::get_id());
}

class PacedExecutor : public ::testing::TestWithParam<int> {
 protected:
  // Number of collect() calls after submit() until the result is returned.
  static int frames_until_handed_over(const Job& job) {
    const auto executor = make_paced_executor(GetParam());
    executor->submit(job);
    int frames = 1;
    while (!executor->collect()) ++frames;
    return frames;
  }
};

TEST_P(PacedExecutor, ReturnsAFastJobExactlyAfterItsLatency) {
  EXPECT_EQ(frames_until_handed_over([] { return std::any(); }), GetParam());
}

TEST_P(PacedExecutor, WaitsForASlowJob) {
  EXPECT_EQ(frames_until_handed_over([] {
              std::this_thread::sleep_for(std::chrono::milliseconds(20));
              return std::any();
            }),
            GetParam());
}

TEST_P(PacedExecutor, WaitsForItsJobInsteadOfItsLatencyIfCollectedEarly) {
  const auto executor = make_paced_executor(GetParam());
  executor->submit([] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    return std::any(7);
  });
  EXPECT_EQ(number_of(executor->collect_early()), 7);
  EXPECT_TRUE(executor->idle());
  EXPECT_FALSE(executor->collect_early());
}

INSTANTIATE_TEST_SUITE_P(Latencies, PacedExecutor, ::testing::Values(1, 2, 5));

TEST_P(PacedExecutor, ReleasesTheResourcesOfAJobBeforeItsResultIsTaken) {
  const auto executor = make_paced_executor(1000);
  auto owned = std::make_shared<int>(7);
  const std::weak_ptr<int> seen = owned;
  executor->submit([owned = std::move(owned)] { return std::any(*owned); });
  while (!seen.expired()) std::this_thread::yield();
  EXPECT_FALSE(executor->idle());
  EXPECT_EQ(number_of(executor->finish()), 7);
}

int niceness() {
  return getpriority(PRIO_PROCESS, static_cast<id_t>(gettid()));
}

int niceness_of_a_job(Executor& executor) {
  executor.submit([] { return niceness(); });
  return number_of(executor.finish());
}

// The caller of a paced executor waits for the job, so its job must keep the usual priority.
TEST(LiveExecutor, RunsAtLowerPriorityThanItsCaller) {
  const int usual = niceness();
  EXPECT_GT(niceness_of_a_job(*make_live_executor()), usual);
  EXPECT_EQ(niceness_of_a_job(*make_paced_executor(1)), usual);
  EXPECT_EQ(niceness_of_a_job(*make_inline_executor()), usual);
  EXPECT_EQ(niceness(), usual);
}

TEST(LiveExecutor, DoesNotWaitForARunningJob) {
  const auto executor = make_live_executor();
  std::promise<void> may_end;
  executor->submit([end = may_end.get_future().share()] {
    end.wait();
    return 9;
  });
  EXPECT_FALSE(executor->collect());
  EXPECT_FALSE(executor->collect_early());
  EXPECT_FALSE(executor->idle());
  may_end.set_value();
  EXPECT_EQ(number_of(collect_when_ready(*executor)), 9);
}

}  // namespace
}  // namespace byre
