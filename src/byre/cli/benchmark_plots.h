#pragma once

#include "byre/cli/benchmark_chart.h"
#include "byre/cli/benchmark_run.h"

namespace byre::cli {

// From above, in the frame of the truth: the truth in grey, and the final poses of each arm's first run.
Chart path_chart(const CaseResult& result);

// Over time: the error of the causal poses of each arm's first run.
Chart error_chart(const CaseResult& result);

}  // namespace byre::cli
