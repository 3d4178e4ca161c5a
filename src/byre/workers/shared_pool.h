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
    const auto free = std::ranges::find_if(known_, [](const auto& known) { return known.use_count() == 1; });
    if (free != known_.end()) {
      std::atomic_thread_fence(std::memory_order_acquire);  // what another thread did with it is done before
      return *free;
    }
    const auto unused = std::ranges::find(known_, nullptr);
    std::shared_ptr<Thing>& made = unused != known_.end() ? *unused : known_[next_forgotten_++ % kMost];
    made = std::make_shared<Thing>();
    return made;
  }

 private:
  static constexpr std::size_t kMost = 8;  // more than are held at a time of what is not kept

  std::array<std::shared_ptr<Thing>, kMost> known_;
  std::size_t next_forgotten_ = 0;
};

}  // namespace byre
