#pragma once

#include <bit>
#include <cstddef>
#include <vector>

namespace byre {

// Thread-local free lists with a limit for each block size, so that steady frames do not allocate. A block may be given
// back on any thread and is kept for that thread. Throws std::bad_alloc.
void* allocate_scratch(std::size_t bytes);
void free_scratch(void* memory, std::size_t bytes) noexcept;  // bytes: the size requested

// Allocator for standard containers, on these free lists.
template <typename Value>
struct ScratchAllocator {
  using value_type = Value;
  static_assert(alignof(Value) <= __STDCPP_DEFAULT_NEW_ALIGNMENT__);

  ScratchAllocator() = default;
  template <typename Other>
  explicit(false) ScratchAllocator(const ScratchAllocator<Other>& /*other*/) noexcept {}

  Value* allocate(std::size_t count) { return static_cast<Value*>(allocate_scratch(count * sizeof(Value))); }
  void deallocate(Value* values, std::size_t count) noexcept { free_scratch(values, count * sizeof(Value)); }

  template <typename Other>
  bool operator==(const ScratchAllocator<Other>& /*other*/) const noexcept {
    return true;
  }
};

// Vector that is rebuilt with each frame.
template <typename Value>
using ScratchVector = std::vector<Value, ScratchAllocator<Value>>;

// Reserves capacity in a list that is refilled each frame, by powers of two, so that small new maxima do not
// reallocate.
template <typename List>
void reserve_pow2(List& list, std::size_t count) {
  if (count > list.capacity()) list.reserve(std::bit_ceil(count));
}

}  // namespace byre
