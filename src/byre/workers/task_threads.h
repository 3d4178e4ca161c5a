#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <functional>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace byre {

// How many threads the machine runs at a time; one at least.
int processor_count();

// Threads that help with short tasks and sleep between them. run() is called from one thread at a time.
class TaskThreads {
 public:
  // While one lives, whoever waits for the others stays awake for some microseconds, as runs follow each other at once:
  // to be woken takes tens of them.
  class Shift {
   public:
    explicit Shift(TaskThreads& threads) : threads_(threads) { threads_.is_on_shift_ = true; }
    ~Shift() { threads_.is_on_shift_ = false; }
    Shift(const Shift&) = delete;
    Shift& operator=(const Shift&) = delete;

   private:
    TaskThreads& threads_;
  };

  explicit TaskThreads(int helpers);  // 0: the caller does all
  TaskThreads(const TaskThreads&) = delete;
  TaskThreads& operator=(const TaskThreads&) = delete;

  // Calls task(0) to task(count - 1), each once, on the calling thread and those that help, and returns when all are
  // done. Tasks are begun in order; the caller waits for none that is not yet begun. Throws what a task threw first.
  template <typename Task>
  void run(int count, const Task& task) {
    run_all(count, std::cref(task));  // a reference needs no memory
  }

 private:
  void run_all(int count, const std::function<void(int)>& task);
  void help(const std::stop_token& stop);
  void work();  // until no task is left
  bool is_left() const { return next_ < count_; }
  // Returns when the condition holds, the shift is over, or it has been too long.
  template <typename Condition>
  void wait_awake(std::chrono::microseconds longest, Condition condition) const;

  std::atomic<bool> is_on_shift_ = false;
  std::mutex mutex_;  // guards all below
  std::condition_variable_any begun_;
  std::condition_variable_any ended_;
  const std::function<void(int)>* task_ = nullptr;
  int count_ = 0;
  int next_ = 0;
  std::atomic<int> runs_ = 0;     // begun so far; read without the mutex, as the next
  std::atomic<int> helping_ = 0;  // helpers at work
  std::exception_ptr failure_;
  std::vector<std::jthread> helpers_;  // last, so that they end first
};

}  // namespace byre
