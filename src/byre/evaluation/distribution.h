#pragma once

#include <vector>

namespace byre {

// Figures of a number of values, in their unit. Percentiles are interpolated between their neighbours.
struct Distribution {
  int count = 0;
  double mean = 0.0;
  double p50 = 0.0;
  double p95 = 0.0;
  double p99 = 0.0;
  double max = 0.0;
};

Distribution distribution_of(std::vector<double> values);  // all zero for none

}  // namespace byre
