#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <memory>

namespace byre {

// Things that are given out frame after frame: those that nobody holds any more are made anew in their own memory. Of
// what is kept, as keyframes are, the memory is forgotten. Whoever holds a thing may let it go from any thread.
template <typename Thing>
class SharedPool {
 public:
  // A thing that nobody else holds, to be filled and given out.
  const std::shared_ptr<Thing>& take() {
    auto taken = std::ranges::find_if(known_, [](const auto& known) { return known.use_count() == 1; });
    if (taken != known_.end()) {
      std::atomic_thread_fence(std::memory_order_acquire);  // what another thread did with it is done before
    } else {
      taken = known_.begin();  // unused, or held for longer than all others
      *taken = std::make_shared<Thing>();
    }
    std::rotate(taken, taken + 1, known_.end());
    return known_.back();
  }

 private:
  static constexpr std::size_t kMost = 8;  // more than are held at a time of what is not kept

  std::array<std::shared_ptr<Thing>, kMost> known_;  // by when they were given out; unused ones first
};

}  // namespace byre
