#include "byre/io/recording/stamp_clock.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

TEST(StampClock, KeepsContinuousStamps) {
  StampClock clock;
  for (int i = 0; i < 5; ++i) {
    const auto reading = clock.read(Timestamp(100s + i * 50ms), Timestamp(i * 900ms));
    EXPECT_EQ(reading.time, Timestamp(100s + i * 50ms)) << "for any delay";
    EXPECT_FALSE(reading.jump);
  }
  EXPECT_FALSE(clock.read(100s + 100ms, 5s).jump) << "a late image";
  EXPECT_FALSE(clock.read(160s, 65s).jump) << "a pause of a minute";
}

TEST(StampClock, SubtractsSteps) {
  StampClock clock;
  clock.read(1000s, 10s);
  const auto back = clock.read(400s, 10s + 50ms);
  ASSERT_TRUE(back.jump);
  EXPECT_EQ(*back.jump, Timestamp(-600s - 50ms));
  EXPECT_EQ(back.time, Timestamp(1000s + 50ms));
  EXPECT_EQ(clock.read(400s + 50ms, 10s + 100ms).time, Timestamp(1000s + 100ms));
  const auto forward = clock.read(4000s, 10s + 150ms);
  ASSERT_TRUE(forward.jump);
  EXPECT_EQ(forward.time, Timestamp(1000s + 150ms));
}

}  // namespace
}  // namespace byre
