#pragma once

#include <cstddef>

namespace byre {

// What operator new has handed out to this thread, whether freed again or not.
struct Allocations {
  std::size_t count = 0;
  std::size_t bytes = 0;
};
Allocations allocations_so_far();

}  // namespace byre
