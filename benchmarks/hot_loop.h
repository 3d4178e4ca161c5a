#pragma once

#include "../tests/allocations.h"

#include <benchmark/benchmark.h>

namespace byre {

// Measures work that is done over and over, once it has been done a few times: until then memory that takes turns is
// still being made. Counters say what this thread allocates each time; tools/check_hot_loops.py compares them, and the
// instructions between the loop's first and last, with those kept in hot_loops.json.
template <typename Work>
void measure_hot_loop(benchmark::State& state, Work&& work) {
  constexpr int kTimesBefore = 3;
  for (int i = 0; i < kTimesBefore; ++i) work();
  const Allocations before = allocations_so_far();
  for (auto _ : state) work();
  const Allocations after = allocations_so_far();
  const auto per_iteration = [](std::size_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kAvgIterations);
  };
  state.counters["allocations"] = per_iteration(after.count - before.count);
  state.counters["allocated_bytes"] = per_iteration(after.bytes - before.bytes);
}

}  // namespace byre
