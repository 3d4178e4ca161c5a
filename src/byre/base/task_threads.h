#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace byre {

// Number of hardware threads; at least 1.
int processor_count();

// Helper threads for short parallel tasks; they sleep between runs. run() is called from one thread at a time.
class TaskThreads {
 public:
  // While a SpinScope lives, waiting threads spin for some microseconds, because waking a thread takes tens of them.
  class SpinScope {
   public:
    explicit SpinScope(TaskThreads& threads) : threads_(threads) { threads_.is_spinning_ = true; }
    ~SpinScope() { threads_.is_spinning_ = false; }
    SpinScope(const SpinScope&) = delete;
    SpinScope& operator=(const SpinScope&) = delete;

   private:
    TaskThreads& threads_;
  };

  explicit TaskThreads(int helpers);  // 0: the caller does all tasks
  TaskThreads(const TaskThreads&) = delete;
  TaskThreads& operator=(const TaskThreads&) = delete;

  // Calls task(0) to task(count - 1) once each, on the calling thread and the helpers, and waits for all. Tasks start
  // in order; the caller never waits for a task that has not started. Rethrows the first exception.
  template <typename Task>
  void run(int count, const Task& task) {
    run_all(count, std::cref(task));  // a reference, so that std::function does not allocate
  }

 private:
  void run_all(int count, const std::function<void(int)>& task);
  void help(const std::stop_token& stop);
  void work();  // until no task is left
  bool has_task_left() const { return next_ < count_; }
  // Returns when the condition holds, the shift ends, or `longest` has passed.
  template <typename Condition>
  void spin_wait(std::chrono::microseconds longest, Condition condition) const;

  std::atomic<bool> is_spinning_ = false;
  std::mutex mutex_;  // guards all members below
  std::condition_variable_any begun_;
  std::condition_variable_any ended_;
  const std::function<void(int)>* task_ = nullptr;
  int count_ = 0;
  int next_ = 0;
  std::atomic<int> runs_ = 0;     // number of runs started; also read without the mutex
  std::atomic<int> helping_ = 0;  // helpers at work; also read without the mutex
  std::exception_ptr failure_;
  std::vector<std::jthread> helpers_;  // last member: joined before the others are destroyed
};

}  // namespace byre
