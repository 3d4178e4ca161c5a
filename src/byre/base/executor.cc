#include "byre/base/executor.h"

#include "byre/base/background_thread.h"
#include "byre/base/serial_queue.h"
#include "byre/base/stopwatch.h"

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
    task();  // stores an exception for collect()
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

// Runs jobs on its own thread; derived classes define when collect() returns results. One thread for all jobs, because
// a new thread may be scheduled before the thread that creates it.
class WorkerExecutor : public Executor {
 public:
  // begin: called once on the thread before the first job.
  explicit WorkerExecutor(void (*begin)() = nullptr) : begin_(begin) {}

  ~WorkerExecutor() override {
    thread_.run([] {});  // waits for the job
  }

  // The job's captures are destroyed on the thread before the result is ready.
  void submit(Job job) override {
    assert(idle());
    if (begin_ != nullptr) thread_.submit(std::exchange(begin_, nullptr));
    const auto task = std::make_shared<std::packaged_task<FinishedJob()>>(
        [job = std::move(job)]() mutable { return run(std::exchange(job, {})); });
    result_ = task->get_future();
    thread_.submit([task] { (*task)(); });
  }
  std::optional<FinishedJob> finish() override {
    if (idle()) return std::nullopt;
    return result_.get();
  }
  bool idle() const override { return !result_.valid(); }

 protected:
  bool is_done() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }

 private:
  void (*begin_)();
  std::future<FinishedJob> result_;
  SerialQueue thread_;  // last member: stopped before the others are destroyed
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
  std::optional<FinishedJob> collect_early() override { return finish(); }

 private:
  const int latency_;  // frames
  int frames_left_ = 0;
};

// Frames never wait for a job, so the job thread has lower priority.
class LiveExecutor final : public WorkerExecutor {
 public:
  LiveExecutor() : WorkerExecutor(lower_thread_priority) {}

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
