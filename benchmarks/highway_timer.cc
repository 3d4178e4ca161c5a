// Highway measures the resolution of its timer as every program starts, by an instruction that valgrind does not know.
// Nothing here asks for it: this stands in, so that the benchmarks can be run under valgrind.

#include <hwy/nanobenchmark.h>

namespace hwy::platform {

uint64_t TimerResolution() {
  return 1;  // ticks
}

}  // namespace hwy::platform
