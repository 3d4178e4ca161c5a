#include "byre/geometry/median.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Median, IsTheMiddleValue) {
  EXPECT_EQ(median(std::vector{3.0, -1.0, 2.0}), 2.0);
}

TEST(Median, IsTheUpperOfTwoMiddleValues) {
  EXPECT_EQ(median(std::vector{4, 1, 3, 2}), 3);
}

TEST(RobustScale, IsTheSpreadOfInliersAndAtLeastOne) {
  EXPECT_DOUBLE_EQ(robust_scale({2.0, 2.0, 2.0, 2.0, 1000.0}), 2.0 * 1.4826);
  EXPECT_DOUBLE_EQ(robust_scale({0.1, 0.2, 0.3}), 1.0);
  EXPECT_DOUBLE_EQ(robust_scale({}), 1.0);
}

}  // namespace
}  // namespace byre
