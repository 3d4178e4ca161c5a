#pragma once

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <utility>

namespace byre {

// Queue whose producer never waits: beyond its capacity it drops the oldest items. With capacity 1 the newest item
// wins.
template <typename Item>
class NewestQueue {
 public:
  explicit NewestQueue(std::size_t capacity) : capacity_(capacity) {}

  void put(Item item) {
    std::optional<Item> dropped;  // destroyed after the mutex is released
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
    if (items_.size() > capacity_) {
      dropped = std::move(items_.front());
      items_.pop_front();
      ++dropped_;
    }
    changed_.notify_one();
  }

  // Ends the queue: take() throws the failure once the remaining items are taken.
  void fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(failure);
    changed_.notify_one();
  }

  // The oldest item; waits up to at_most for it, else empty. Throws the failure of a queue that has ended.
  std::optional<Item> take(std::chrono::milliseconds at_most) {
    std::unique_lock lock(mutex_);
    changed_.wait_for(lock, at_most, [this] { return !items_.empty() || failure_; });
    if (items_.empty()) {
      if (failure_) std::rethrow_exception(failure_);
      return std::nullopt;
    }
    std::optional<Item> item = std::move(items_.front());
    items_.pop_front();
    return item;
  }

  int dropped() const {
    const std::lock_guard lock(mutex_);
    return dropped_;
  }

 private:
  const std::size_t capacity_;
  mutable std::mutex mutex_;
  std::condition_variable changed_;
  // All guarded by mutex_.
  std::deque<Item> items_;
  std::exception_ptr failure_;
  int dropped_ = 0;
};

}  // namespace byre
