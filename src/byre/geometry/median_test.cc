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

}  // namespace
}  // namespace byre
