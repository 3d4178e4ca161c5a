#include "byre/playback/frame_source.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

bool never() {
  return false;
}

TEST(LiveClock, StartsWithItsFirstFrame) {
  LiveClock clock;
  EXPECT_EQ(clock.wait_until_due(hours(1), never), 0.0);
}

TEST(LiveClock, MeasuresTheLatenessOfAFrame) {
  LiveClock clock;
  clock.wait_until_due(seconds(10), never);
  EXPECT_GE(clock.wait_until_due(seconds(7), never), 3.0);
}

TEST(LiveClock, WaitsForAFutureFrame) {
  LiveClock clock;
  const auto start = std::chrono::steady_clock::now();
  clock.wait_until_due(Timestamp(0), never);
  clock.wait_until_due(milliseconds(70), never);
  EXPECT_GE(std::chrono::steady_clock::now() - start, milliseconds(70));
}

TEST(LiveClock, StopsWaitingOnRequest) {
  LiveClock clock;
  clock.wait_until_due(Timestamp(0), never);
  EXPECT_EQ(clock.wait_until_due(hours(1), [] { return true; }), 0.0);
}

}  // namespace
}  // namespace byre
