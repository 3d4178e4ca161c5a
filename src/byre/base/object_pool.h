#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

namespace byre {

// Pool of objects handed out frame after frame. Objects without other owners are reused with their memory; objects that
// stay in use, such as keyframes, leave the pool. Owners may release an object on any thread.
template <typename Thing>
class ObjectPool {
 public:
  // An object without other owners, to be filled and handed out.
  const std::shared_ptr<Thing>& take() {
    auto taken = std::ranges::find_if(known_, [](const auto& known) { return known.use_count() == 1; });
    if (taken != known_.end()) {
      std::atomic_thread_fence(std::memory_order_acquire);  // orders the last owner's accesses before the reuse
    } else {
      taken = known_.begin();  // unused, or held for longer than all others
      *taken = std::make_shared<Thing>();
    }
    std::rotate(taken, taken + 1, known_.end());
    return known_.back();
  }

 private:
  static constexpr std::size_t kMost = 8;  // more than the number of short-lived objects held at a time

  std::array<std::shared_ptr<Thing>, kMost> known_;  // in order of handing out; unused ones first
};

}  // namespace byre
