// Replaces a function of Highway that runs at program start and executes an instruction unknown to valgrind. Its result
// is unused here.

#include <hwy/nanobenchmark.h>

namespace hwy::platform {

uint64_t TimerResolution() {
  return 1;  // ticks
}

}  // namespace hwy::platform
