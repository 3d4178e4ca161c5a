#include "byre/features/image_threads.h"

#include <gtest/gtest.h>
#include <opencv2/core/utility.hpp>

namespace byre {
namespace {

TEST(LimitImageThreads, AppliesToAllOfOpencv) {
  const int before = cv::getNumThreads();
  limit_image_threads(1);
  EXPECT_EQ(cv::getNumThreads(), 1);
  limit_image_threads(before);
  EXPECT_EQ(cv::getNumThreads(), before);
}

}  // namespace
}  // namespace byre
