#include "byre/workers/executor.h"

#include "byre/workers/stopwatch.h"

#include <cassert>
#include <chrono>
#include <future>
#include <utility>

namespace byre {
namespace {

FinishedJob run(const Job& job) {
  const Stopwatch watch;
  std::any result = job();
  return {std::move(result), watch.seconds()};
}

class InlineExecutor final : public Executor {
 public:
  void submit(Job job) override {
    assert(idle());
    std::packaged_task<FinishedJob()> task([&job] { return run(job); });
    result_ = task.get_future();
    task();  // keeps an exception for collect()
  }
  std::optional<FinishedJob> collect() override {
    if (idle()) return std::nullopt;
    return result_.get();
  }
  std::optional<FinishedJob> finish() override { return collect(); }
  bool idle() const override { return !result_.valid(); }

 private:
  std::future<FinishedJob> result_;
};

// Runs each job on a thread of its own; when its result is handed over is left open. What the job owns goes on that
// thread, before the result is there.
class WorkerExecutor : public Executor {
 public:
  void submit(Job job) override {
    assert(idle());
    result_ = std::async(std::launch::async, [job = std::move(job)]() mutable { return run(std::exchange(job, {})); });
  }
  std::optional<FinishedJob> finish() override {
    if (idle()) return std::nullopt;
    return result_.get();
  }
  bool idle() const override { return !result_.valid(); }

 protected:
  bool is_done() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }

 private:
  std::future<FinishedJob> result_;
};

class PacedExecutor final : public WorkerExecutor {
 public:
  explicit PacedExecutor(int latency) : latency_(latency) { assert(latency > 0); }

  void submit(Job job) override {
    WorkerExecutor::submit(std::move(job));
    frames_left_ = latency_;
  }
  std::optional<FinishedJob> collect() override {
    if (idle() || --frames_left_ > 0) return std::nullopt;
    return finish();
  }

 private:
  const int latency_;  // frames
  int frames_left_ = 0;
};

class LiveExecutor final : public WorkerExecutor {
 public:
  std::optional<FinishedJob> collect() override {
    if (idle() || !is_done()) return std::nullopt;
    return finish();
  }
};

}  // namespace

std::unique_ptr<Executor> make_inline_executor() {
  return std::make_unique<InlineExecutor>();
}
std::unique_ptr<Executor> make_paced_executor(int latency) {
  return std::make_unique<PacedExecutor>(latency);
}
std::unique_ptr<Executor> make_live_executor() {
  return std::make_unique<LiveExecutor>();
}

}  // namespace byre
