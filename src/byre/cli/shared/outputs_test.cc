#include "byre/cli/shared/outputs.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

TEST(GivenPaths, ListsFilesThatAreGiven) {
  EXPECT_TRUE(given_paths({std::nullopt, std::nullopt}).empty());
  EXPECT_THAT(given_paths({"barn.byre", std::nullopt, "final.txt"}), testing::ElementsAre("barn.byre", "final.txt"));
}

}  // namespace
}  // namespace byre::cli
