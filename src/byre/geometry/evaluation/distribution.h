#pragma once

#include <vector>

namespace byre {

// Statistics of values, in their unit. Percentiles are interpolated.
struct Distribution {
  int count = 0;
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

Distribution distribution_of(std::vector<double> values);  // all zero for an empty vector

}  // namespace byre
