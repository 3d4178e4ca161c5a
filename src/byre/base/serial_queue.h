#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <utility>

namespace byre {

// Runs tasks one at a time, in the order of their calls, from any thread: those of submit() on a thread of its own,
// those of run() on the caller's.
class SerialQueue {
 public:
  SerialQueue();
  ~SerialQueue() { stop(); }
  SerialQueue(const SerialQueue&) = delete;
  SerialQueue& operator=(const SerialQueue&) = delete;

  // Queues a task. If more than `most` tasks with an `instead` wait then, the oldest of these is replaced by its
  // `instead`, in its place. Tasks are destroyed on the thread after they ran, or on that of the caller.
  void submit(std::function<void()> task, std::function<void()> instead = {}, std::size_t most = 0);

  // Waits for the tasks before, then runs the task. Within a task: runs it at once.
  template <typename Task>
  auto run(const Task& task) {
    const Turn turn(*state_);
    return task();
  }

  // Same as submit() without waiting; runs the task at once as long as submit() was not called.
  template <typename Task>
  void add(Task task) {
    if (has_thread()) {
      submit(std::move(task));
    } else {
      run(task);
    }
  }

  // Throws the first exception of submitted tasks since the last call.
  void rethrow_failure();

  // Waits for the current task, unless called within it, and discards those that wait. No call may follow.
  void stop();

 private:
  class State;

  // Right to run, until its end.
  class Turn {
   public:
    explicit Turn(State& state);
    ~Turn();
    Turn(const Turn&) = delete;
    Turn& operator=(const Turn&) = delete;

   private:
    State& state_;
    bool is_nested_;
  };

  bool has_thread() const;

  std::shared_ptr<State> state_;  // shared with the thread, because a task may destroy its queue
};

}  // namespace byre
