#include "byre/base/report_row.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(FormatDuration, OmitsZeroHours) {
  EXPECT_EQ(format_duration(0.0), "0:00");
  EXPECT_EQ(format_duration(6.2), "0:07");
  EXPECT_EQ(format_duration(754.0), "12:34");
  EXPECT_EQ(format_duration(3723.0), "1:02:03");
}

}  // namespace
}  // namespace byre
