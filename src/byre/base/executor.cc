#include "byre/base/executor.h"

#include "byre/base/background_thread.h"
#include "byre/base/stopwatch.h"

#include <cassert>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <future>
#include <mutex>
#include <thread>
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

// Thread that runs jobs one after the other, started with the first job. One thread for all jobs, because a new thread
// may be scheduled before the thread that creates it.
class JobThread {
 public:
  // begin: called once on the thread before the first job.
  explicit JobThread(std::function<void()> begin) : begin_(std::move(begin)) {}
  ~JobThread() {
    {
      const std::lock_guard lock(mutex_);
      is_over_ = true;
    }
    news_.notify_one();
  }
  JobThread(const JobThread&) = delete;
  JobThread& operator=(const JobThread&) = delete;

  // The job's captures are destroyed on the thread before the result is ready.
  std::future<FinishedJob> start(Job job) {
    std::packaged_task<FinishedJob()> task([job = std::move(job)]() mutable { return run(std::exchange(job, {})); });
    std::future<FinishedJob> result = task.get_future();
    {
      const std::lock_guard lock(mutex_);
      next_ = std::move(task);
    }
    if (thread_.joinable()) {
      news_.notify_one();
    } else {
      thread_ = std::jthread([this] { work(); });
    }
    return result;
  }

 private:
  void work() {
    begin_();
    std::unique_lock lock(mutex_);
    while (true) {
      news_.wait(lock, [this] { return is_over_ || next_.valid(); });
      if (!next_.valid()) return;
      auto task = std::move(next_);
      lock.unlock();
      task();
      lock.lock();
    }
  }

  std::function<void()> begin_;
  std::mutex mutex_;  // guards next_ and is_over_
  std::condition_variable news_;
  std::packaged_task<FinishedJob()> next_;
  bool is_over_ = false;
  std::jthread thread_;  // last member: joined before the others are destroyed
};

// Runs jobs on its own thread; derived classes define when collect() returns results.
class WorkerExecutor : public Executor {
 public:
  explicit WorkerExecutor(std::function<void()> begin = [] {}) : thread_(std::move(begin)) {}

  void submit(Job job) override {
    assert(idle());
    result_ = thread_.start(std::move(job));
  }
  std::optional<FinishedJob> finish() override {
    if (idle()) return std::nullopt;
    return result_.get();
  }
  bool idle() const override { return !result_.valid(); }

 protected:
  bool is_done() const { return result_.wait_for(std::chrono::seconds(0)) == std::future_status::ready; }

 private:
  JobThread thread_;
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
