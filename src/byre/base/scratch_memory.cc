#include "byre/base/scratch_memory.h"

#include <array>
#include <new>

namespace byre {
namespace {

constexpr std::size_t kSmallest = 256;                   // bytes; smaller blocks are rounded up to this size
constexpr std::size_t kLargest = std::size_t{1} << 20U;  // bytes; larger blocks are not kept
constexpr std::size_t kSizes = std::bit_width(kLargest / kSmallest);
constexpr std::size_t kKeptOfSize = 8;

std::size_t size_of_block(std::size_t bytes) {
  return bytes > kLargest ? bytes : std::bit_ceil(bytes < kSmallest ? kSmallest : bytes);
}

struct KeptBlocks {
  std::array<void*, kKeptOfSize> blocks;
  std::size_t count = 0;
};

// Blocks that outlive their thread's store are freed at once.
thread_local bool is_store_gone = false;

class Store {
 public:
  Store() = default;
  Store(const Store&) = delete;
  Store& operator=(const Store&) = delete;
  ~Store() {
    is_store_gone = true;
    for (const KeptBlocks& kept : kept_) {
      for (std::size_t i = 0; i < kept.count; ++i) ::operator delete(kept.blocks[i]);
    }
  }

  void* take(std::size_t size) {
    KeptBlocks& kept = of_size(size);
    return kept.count == 0 ? nullptr : kept.blocks[--kept.count];
  }

  bool keep(void* memory, std::size_t size) {
    KeptBlocks& kept = of_size(size);
    if (kept.count == kKeptOfSize) return false;
    kept.blocks[kept.count++] = memory;
    return true;
  }

 private:
  KeptBlocks& of_size(std::size_t size) { return kept_[std::bit_width(size / kSmallest) - 1]; }

  std::array<KeptBlocks, kSizes> kept_{};
};

Store& store_of_thread() {
  thread_local Store store;
  return store;
}

}  // namespace

void* allocate_scratch(std::size_t bytes) {
  const std::size_t size = size_of_block(bytes);
  if (size <= kLargest && !is_store_gone) {
    if (void* const kept = store_of_thread().take(size)) return kept;
  }
  return ::operator new(size);
}

void free_scratch(void* memory, std::size_t bytes) noexcept {
  const std::size_t size = size_of_block(bytes);
  if (size <= kLargest && !is_store_gone && store_of_thread().keep(memory, size)) return;
  ::operator delete(memory);
}

}  // namespace byre
