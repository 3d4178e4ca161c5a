#pragma once

#include <atomic>
#include <memory>
#include <utility>

namespace byre {

// Value whose copies share memory until one of them changes (copy on write). Different threads may use different
// copies. A default value takes no memory.
template <typename Value>
class Shared {
 public:
  Shared() = default;
  explicit Shared(Value value) : value_(std::make_shared<Value>(std::move(value))) {}

  const Value& operator*() const { return value_ ? *value_ : default_value(); }
  const Value* operator->() const { return &**this; }
  // The value, without a test for a default one. Precondition: it was changed or given.
  const Value& given() const { return *value_; }

  // The value, to change it; copied first while other copies share it. References obtained before are invalid then.
  Value& edit() {
    if (value_.use_count() != 1) {
      value_ = std::make_shared<Value>(**this);
    } else {
      // Orders the accesses of a copy just destroyed before the change.
      std::atomic_thread_fence(std::memory_order_acquire);
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
      const std::shared_ptr<Value> ordered = value_;  // the thread sanitizer models copies, not fences
#endif
#endif
    }
    return *value_;
  }

 private:
  static const Value& default_value() {
    static const Value value{};
    return value;
  }

  std::shared_ptr<Value> value_;  // nullptr: the default value
};

}  // namespace byre
