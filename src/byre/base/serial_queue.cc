#include "byre/base/serial_queue.h"

#include <algorithm>
#include <cassert>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <mutex>
#include <thread>

namespace byre {

// Never destroys a task or an exception with its mutex locked: they may lock others.
class SerialQueue::State {
 public:
  void submit(std::function<void()> task, std::function<void()> instead, std::size_t most) {
    const std::lock_guard lock(mutex_);
    assert(!is_over_);
    waiting_.push_back({next_++, std::move(task), std::move(instead)});
    const auto is_replaceable = [](const Waiting& each) { return static_cast<bool>(each.instead); };
    if (waiting_.back().instead && static_cast<std::size_t>(std::ranges::count_if(waiting_, is_replaceable)) > most) {
      Waiting& oldest = *std::ranges::find_if(waiting_, is_replaceable);
      task = std::exchange(oldest.task, std::exchange(oldest.instead, {}));  // destroyed with the lock released
    }
    changed_.notify_all();
  }

  // Whether the calling thread runs a task already.
  bool enter() {
    std::unique_lock lock(mutex_);
    if (owner_ == std::this_thread::get_id()) return true;
    const std::uint64_t turn = next_++;
    changed_.wait(lock, [&] { return is_free(turn); });
    owner_ = std::this_thread::get_id();
    return false;
  }

  void leave() {
    const std::lock_guard lock(mutex_);
    leave_locked();
  }

  static void start(const std::shared_ptr<State>& state) {
    const std::lock_guard lock(state->mutex_);
    if (!state->thread_.joinable()) state->thread_ = std::thread([state] { state->work(); });
  }

  bool has_thread() const {
    const std::lock_guard lock(mutex_);
    return thread_.joinable();
  }

  void rethrow_failure() {
    std::unique_lock lock(mutex_);
    const std::exception_ptr failure = std::exchange(failure_, nullptr);
    lock.unlock();
    if (failure) std::rethrow_exception(failure);
  }

  void stop() {
    std::deque<Waiting> discarded;
    std::unique_lock lock(mutex_);
    is_over_ = true;
    discarded.swap(waiting_);
    std::thread thread = std::move(thread_);
    changed_.notify_all();
    lock.unlock();
    if (!thread.joinable()) return;
    if (thread.get_id() == std::this_thread::get_id()) {
      thread.detach();
    } else {
      thread.join();
    }
  }

 private:
  struct Waiting {
    std::uint64_t turn = 0;
    std::function<void()> task;
    std::function<void()> instead;  // empty: not replaceable
  };

  bool is_free(std::uint64_t turn) const { return owner_ == std::thread::id() && turn == done_; }

  void leave_locked() {
    owner_ = {};
    ++done_;
    changed_.notify_all();
  }

  void work() {
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return is_over_ || (!waiting_.empty() && is_free(waiting_.front().turn)); });
      if (is_over_) return;
      Waiting next = std::move(waiting_.front());
      waiting_.pop_front();
      owner_ = std::this_thread::get_id();
      lock.unlock();
      keep(failure_of(next.task));
      next = {};
      lock.lock();
      leave_locked();
    }
  }

  static std::exception_ptr failure_of(const std::function<void()>& task) {
    try {
      task();
    } catch (...) {
      return std::current_exception();
    }
    return nullptr;
  }

  void keep(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    if (!failure_) std::swap(failure, failure_);
  }

  mutable std::mutex mutex_;  // guards all members
  std::condition_variable changed_;
  std::deque<Waiting> waiting_;
  std::uint64_t next_ = 0;  // turn of the next call
  std::uint64_t done_ = 0;  // turns that have ended
  std::thread::id owner_;   // thread that runs a task
  std::exception_ptr failure_;
  std::thread thread_;
  bool is_over_ = false;
};

SerialQueue::SerialQueue() : state_(std::make_shared<State>()) {}

void SerialQueue::submit(std::function<void()> task, std::function<void()> instead, std::size_t most) {
  state_->submit(std::move(task), std::move(instead), most);
  State::start(state_);
}

void SerialQueue::rethrow_failure() {
  state_->rethrow_failure();
}

void SerialQueue::stop() {
  state_->stop();
}

bool SerialQueue::has_thread() const {
  return state_->has_thread();
}

SerialQueue::Turn::Turn(State& state) : state_(state), is_nested_(state.enter()) {}

SerialQueue::Turn::~Turn() {
  if (!is_nested_) state_.leave();
}

}  // namespace byre
