#pragma once

#include <bit>
#include <cstddef>
#include <vector>

namespace byre {

// Blocks that this thread has let go of, kept for what it asks for next, up to some of each size: a frame asks for the
// same lists as the frame before, and shall not ask the system for them. Give back on any thread what was taken on any
// other; what comes back is kept for the thread that gives it. Throws std::bad_alloc.
void* take_reused_memory(std::size_t bytes);
void give_reused_memory(void* memory, std::size_t bytes) noexcept;  // bytes: as they were asked for

// An allocator of the standard library's containers.
template <typename Value>
struct ReusingAllocator {
  using value_type = Value;
  static_assert(alignof(Value) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

  ReusingAllocator() = default;
  template <typename Other>
  explicit(false) ReusingAllocator(const ReusingAllocator<Other>& /*other*/) noexcept {}

  Value* allocate(std::size_t count) { return static_cast<Value*>(take_reused_memory(count * sizeof(Value))); }
  void deallocate(Value* values, std::size_t count) noexcept { give_reused_memory(values, count * sizeof(Value)); }

  template <typename Other>
  bool operator==(const ReusingAllocator<Other>& /*other*/) const noexcept {
    return true;
  }
};

// A list that is made anew with every frame.
template <typename Value>
using ReusedVector = std::vector<Value, ReusingAllocator<Value>>;

// Room for so many in a list that is kept from frame to frame and filled anew each time. In powers of two: a list that
// is longer now and then by a few asks the system once, and not each time that it is the longest so far.
template <typename List>
void make_room(List& list, std::size_t count) {
  if (count > list.capacity()) list.reserve(std::bit_ceil(count));
}

}  // namespace byre
