#pragma once

#include "byre/benchmark/benchmark_run.h"
#include "byre/benchmark/chart.h"

namespace byre {

// From above, in the frame of the truth: the truth in grey, and the final poses of each arm's first run.
Chart path_chart(const CaseResult& result);

// Over time: the error of the causal poses of each arm's first run.
Chart error_chart(const CaseResult& result);

}  // namespace byre
