#include "byre/simulation/row_workers.h"

#include <atomic>
#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::Eq;

class RowWorkers : public ::testing::TestWithParam<int> {};

TEST_P(RowWorkers, ProcessEachRowOnce) {
  std::vector<std::atomic<int>> done(37);
  for_each_row(37, GetParam(), [&](int row) { ++done[static_cast<std::size_t>(row)]; });
  EXPECT_THAT(done, Each(Eq(1)));
}

TEST_P(RowWorkers, ProcessNothingWithoutRows) {
  int calls = 0;
  for_each_row(0, GetParam(), [&](int) { ++calls; });
  EXPECT_EQ(calls, 0);
}

INSTANTIATE_TEST_SUITE_P(Threads, RowWorkers, ::testing::Values(0, 1, 2, 64));

}  // namespace
}  // namespace byre
