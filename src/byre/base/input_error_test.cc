#include "byre/input_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(InputError, JoinsPlaceReasonAndRemedy) {
  const InputError error("sensor.yaml:12", "no focal length", "add 'intrinsics'");
  EXPECT_STREQ(error.what(), "sensor.yaml:12: no focal length (add 'intrinsics')");
}

TEST(InputError, OmitsAnEmptyRemedy) {
  EXPECT_STREQ(InputError("mission.map", "not a map file").what(), "mission.map: not a map file");
}

TEST(InputError, KeepsItsParts) {
  const InputError error("a.csv", "empty", "record again");
  EXPECT_EQ(error.place(), "a.csv");
  EXPECT_EQ(error.reason(), "empty");
  EXPECT_EQ(error.remedy(), "record again");
}

TEST(InputError, IsCaughtAsARuntimeError) {
  EXPECT_THAT([] { throw InputError("a.csv", "empty"); }, testing::ThrowsMessage<std::runtime_error>("a.csv: empty"));
}

}  // namespace
}  // namespace byre
