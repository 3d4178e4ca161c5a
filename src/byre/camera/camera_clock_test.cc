#include "byre/camera/live_cameras.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""s;
using std::chrono_literals::operator""ms;

constexpr MachineTime kNow{5000s, 1'800'000'000s};

TEST(CameraClock, IsTheClockNearestToTheStamp) {
  EXPECT_EQ(clock_of(4999s, kNow), CameraClock::monotonic);
  EXPECT_EQ(clock_of(1'799'999'999s, kNow), CameraClock::utc);
  EXPECT_EQ(clock_of(1'403'636'580s, kNow), CameraClock::own);
  EXPECT_EQ(clock_of(0s, kNow), CameraClock::own);
}

TEST(CameraClock, IsConvertedToUtcByOneOffset) {
  EXPECT_EQ(4999s + utc_offset(CameraClock::monotonic, kNow), 1'799'999'999s);
  EXPECT_EQ(utc_offset(CameraClock::utc, kNow), 0s);
  EXPECT_EQ(utc_offset(CameraClock::own, kNow), 0s);
}

TEST(CameraClock, OfTheMachineIncreases) {
  const MachineTime before = machine_time();
  const MachineTime after = machine_time();
  EXPECT_GE(after.monotonic, before.monotonic);
  EXPECT_NE(before.utc, 0ms);
}

}  // namespace
}  // namespace byre
