#pragma once

#include <cstddef>

namespace byre {

// Total of operator new in this thread, including freed memory.
struct Allocations {
  std::size_t count = 0;
  std::size_t bytes = 0;
};
Allocations allocations_so_far();

}  // namespace byre
