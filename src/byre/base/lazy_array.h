#pragma once

#include <atomic>
#include <cstddef>
#include <memory>

namespace byre {

// Array of lazily created values. Any thread may request a value, and none waits for another: if two create the same
// value at once, the first one finished is kept.
template <typename Thing>
class LazyArray {
 public:
  explicit LazyArray(std::size_t count)
      : count_(count), things_(std::make_unique<std::atomic<const Thing*>[]>(count)) {}
  ~LazyArray() {
    for (std::size_t i = 0; i < count_; ++i) delete things_[i].load(std::memory_order_acquire);
  }
  LazyArray(const LazyArray&) = delete;
  LazyArray& operator=(const LazyArray&) = delete;

  // nullptr if the value does not exist yet.
  const Thing* find(std::size_t index) const { return things_[index].load(std::memory_order_acquire); }

  // Creates the value by make() if it does not exist. An exception of make() propagates; the next call tries again.
  template <typename Make>
  const Thing& get(std::size_t index, Make make) const {
    std::atomic<const Thing*>& place = things_[index];
    if (const Thing* const known = place.load(std::memory_order_acquire)) return *known;
    auto made = std::make_unique<const Thing>(make());
    const Thing* known = nullptr;
    if (!place.compare_exchange_strong(known, made.get(), std::memory_order_acq_rel)) return *known;
    return *made.release();
  }

 private:
  std::size_t count_;
  std::unique_ptr<std::atomic<const Thing*>[]> things_;  // nullptr until created
};

}  // namespace byre
