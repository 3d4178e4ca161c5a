#include "byre/base/nearest_name.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Eq;
using testing::Optional;

const std::vector<std::string> kNames = {"map", "run", "bag", "validate", "--trajectory", "--track", "import-colmap"};

TEST(NearestName, CorrectsMistakes) {
  EXPECT_THAT(nearest_name("mpa", kNames), Optional(Eq("map")));
  EXPECT_THAT(nearest_name("mapp", kNames), Optional(Eq("map")));
  EXPECT_THAT(nearest_name("ban", kNames), Optional(Eq("bag")));
  EXPECT_THAT(nearest_name("validat", kNames), Optional(Eq("validate")));
  EXPECT_THAT(nearest_name("--tracjetroy", kNames), Optional(Eq("--trajectory")));
}

TEST(NearestName, CompletesParts) {
  EXPECT_THAT(nearest_name("--traj", kNames), Optional(Eq("--trajectory")));
  EXPECT_THAT(nearest_name("colmap", kNames), Optional(Eq("import-colmap")));
}

TEST(NearestName, IsEmptyForOtherNames) {
  for (const char* const other : {"", "x", "fly", "frobnicate", "--resolution"}) {
    EXPECT_THAT(nearest_name(other, kNames), Eq(std::nullopt)) << other;
  }
  EXPECT_THAT(nearest_name("map", {}), Eq(std::nullopt));
}

}  // namespace
}  // namespace byre
