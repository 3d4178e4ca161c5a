#include "byre/cli/map/options.h"

#include <gtest/gtest.h>

namespace byre::cli {
namespace {

TEST(MapOptions, ListsTheRequestedOutputs) {
  MapOptions options;
  EXPECT_TRUE(options.outputs().empty());
  options.map = "barn.byre";
  options.trajectory = "final.txt";
  EXPECT_EQ(options.outputs().size(), 2u);
  options.stats = "stats.json";
  options.causal_trajectory = "causal.txt";
  EXPECT_EQ(options.outputs().size(), 4u);
}

}  // namespace
}  // namespace byre::cli
