#pragma once

#include "../tests/allocations.h"

#include <benchmark/benchmark.h>

#if __has_include(<valgrind/callgrind.h>)
#include <valgrind/callgrind.h>
#else
#define CALLGRIND_START_INSTRUMENTATION
#define CALLGRIND_STOP_INSTRUMENTATION
#define CALLGRIND_DUMP_STATS
#endif

namespace byre {

// Measures repeated work after a few warm-up passes, in which reused memory is allocated. Counters report allocations
// of this thread per pass; tools/check_hot_loops.py compares them, and the instructions of one pass, with
// hot_loops.json. Callgrind counts instructions of the loop only, and writes them after it.
template <typename Work>
void measure_hot_loop(benchmark::State& state, Work&& work) {
  constexpr int kTimesBefore = 3;
  for (int i = 0; i < kTimesBefore; ++i) work();
  const Allocations before = allocations_so_far();
  CALLGRIND_START_INSTRUMENTATION;
  for (auto _ : state) work();
  CALLGRIND_DUMP_STATS;
  CALLGRIND_STOP_INSTRUMENTATION;
  const Allocations after = allocations_so_far();
  const auto per_iteration = [](std::size_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  };
  state.counters["allocations"] = per_iteration(after.count - before.count);
  state.counters["allocated_bytes"] = per_iteration(after.bytes - before.bytes);
}

}  // namespace byre
