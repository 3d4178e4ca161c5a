#include "byre/geometry/evaluation/distribution.h"

#include <numeric>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Distribution, SummarisesValuesInAnyOrder) {
  std::vector<double> values(101);
  std::iota(values.rbegin(), values.rend(), 0.0);
  const Distribution distribution = distribution_of(values);
  EXPECT_EQ(distribution.count, 101);
  EXPECT_DOUBLE_EQ(distribution.mean, 50.0);
  EXPECT_DOUBLE_EQ(distribution.p50, 50.0);
  EXPECT_DOUBLE_EQ(distribution.p95, 95.0);
  EXPECT_DOUBLE_EQ(distribution.p99, 99.0);
  EXPECT_DOUBLE_EQ(distribution.max, 100.0);
}

TEST(Distribution, IsZeroWithoutValues) {
  const Distribution distribution = distribution_of({});
  EXPECT_EQ(distribution.count, 0);
  EXPECT_EQ(distribution.mean, 0.0);
  EXPECT_EQ(distribution.max, 0.0);
}

}  // namespace
}  // namespace byre
