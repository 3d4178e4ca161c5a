#pragma once

#include "byre/benchmark/benchmark_run.h"
#include "byre/benchmark/chart.h"

namespace byre {

// View from above in the truth's frame: truth in grey, and final poses of each arm's first run.
Chart path_chart(const CaseResult& result);

// Error over time of the causal poses of each arm's first run.
Chart error_chart(const CaseResult& result);

}  // namespace byre
