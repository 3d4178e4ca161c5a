#include "byre/base/task_threads.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

// Spin limits. The caller waits for one task at most, and the helper may need the caller's processor to finish it.
constexpr std::chrono::microseconds kForHelpers(50);
constexpr std::chrono::microseconds kForCaller(200);

}  // namespace

int processor_count() {
  return static_cast<int>(std::max(std::thread::hardware_concurrency(), 1u));
}

TaskThreads::TaskThreads(int helpers) {
  for (int i = 0; i < helpers; ++i) {
    helpers_.emplace_back([this](const std::stop_token& stop) { help(stop); });
  }
}

void TaskThreads::run_all(int count, const std::function<void(int)>& task) {
  if (helpers_.empty()) {
    for (int i = 0; i < count; ++i) task(i);
    return;
  }
  {
    const std::scoped_lock lock(mutex_);
    task_ = &task;
    count_ = count;
    next_ = 0;
    ++runs_;
  }
  begun_.notify_all();
  work();
  spin_wait(kForHelpers, [this] { return helping_ == 0; });
  std::unique_lock lock(mutex_);
  ended_.wait(lock, [this] { return helping_ == 0; });
  if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
}

template <typename Condition>
void TaskThreads::spin_wait(std::chrono::microseconds longest, Condition condition) const {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point end = Clock::now() + longest;
  while (is_spinning_ && !condition() && Clock::now() < end) continue;
}

void TaskThreads::help(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  while (begun_.wait(lock, stop, [this] { return has_task_left(); })) {
    ++helping_;
    lock.unlock();
    work();
    lock.lock();
    const int runs = runs_;
    if (--helping_ == 0) ended_.notify_one();
    lock.unlock();
    spin_wait(kForCaller, [&] { return runs_ != runs; });
    lock.lock();
  }
}

void TaskThreads::work() {
  std::unique_lock lock(mutex_);
  while (has_task_left()) {
    const int mine = next_++;
    lock.unlock();
    try {
      (*task_)(mine);
    } catch (...) {
      const std::scoped_lock failed(mutex_);
      if (!failure_) failure_ = std::current_exception();
      next_ = count_;
    }
    lock.lock();
  }
}

}  // namespace byre
