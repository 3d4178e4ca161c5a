#include "byre/geometry/evaluation/distribution.h"

#include "byre/trajectory_error.h"

#include <algorithm>
#include <numeric>

namespace byre {

Distribution distribution_of(std::vector<double> values) {
  if (values.empty()) return {};
  std::ranges::sort(values);
  Distribution distribution;
  distribution.count = static_cast<int>(values.size());
  distribution.mean = std::accumulate(values.begin(), values.end(), 0.0) / distribution.count;
  distribution.p50 = quantile(values, 0.5);
  distribution.p95 = quantile(values, 0.95);
  distribution.p99 = quantile(values, 0.99);
  distribution.max = values.back();
  return distribution;
}

}  // namespace byre
