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

// A queue from one thread to another that never keeps the first one waiting: what is beyond its capacity is dropped,
// the oldest first. With a capacity of one the newest wins.
template <typename Item>
class NewestQueue {
 public:
  explicit NewestQueue(std::size_t capacity) : capacity_(capacity) {}

  void put(Item item) {
    std::optional<Item> dropped;  // freed once the mutex is
    const std::lock_guard lock(mutex_);
    items_.push_back(std::move(item));
    if (items_.size() > capacity_) {
      dropped = std::move(items_.front());
      items_.pop_front();
      ++dropped_;
    }
    changed_.notify_one();
  }

  // No item will come any more: this is thrown once those that wait are taken.
  void fail(std::exception_ptr failure) {
    const std::lock_guard lock(mutex_);
    failure_ = std::move(failure);
    changed_.notify_one();
  }

  // The oldest item, waited for at most so long.
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
  // All guarded by the mutex.
  std::deque<Item> items_;
  std::exception_ptr failure_;
  int dropped_ = 0;
};

}  // namespace byre
