#include "byre/slam/frame/fault_latch.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kStep = 0.05;  // seconds between frames

class LastingDoubtTest : public ::testing::Test {
 protected:
  // Notes a number of frames with the same sign. Returns the number of frames at which the doubt was raised.
  int note(int frames, Sign sign, double step = kStep) {
    int raised = 0;
    for (int i = 0; i < frames; ++i) {
      time_ += from_seconds(step);
      doubt_.note(time_, sign);
      if (doubt_.is_raised()) ++raised;
    }
    return raised;
  }

  FaultLatch doubt_;
  Timestamp time_{};
};

TEST_F(LastingDoubtTest, IsNotRaisedWithoutACause) {
  EXPECT_EQ(note(100, Sign::absent) + note(100, Sign::unclear), 0);
}

TEST_F(LastingDoubtTest, IsRaisedByTheFirstSignAndLastsASecondLonger) {
  EXPECT_EQ(note(1, Sign::present), 1);
  const int frames = note(100, Sign::absent);
  EXPECT_GE(frames, static_cast<int>(FaultLatch::kLeastSeconds / kStep) - 1);
  EXPECT_LE(frames, static_cast<int>(FaultLatch::kLeastSeconds / kStep) + 1);
}

TEST_F(LastingDoubtTest, RequiresFramesAtLowRates) {
  note(1, Sign::present, 1.0);
  EXPECT_EQ(note(20, Sign::absent, 1.0), FaultLatch::kLeastFrames - 1);
}

TEST_F(LastingDoubtTest, LastsAsLongAsItsCauseDid) {
  note(100, Sign::present);
  EXPECT_NEAR(note(1000, Sign::absent) * kStep, 100 * kStep + FaultLatch::kLeastSeconds, 3 * kStep);
}

TEST_F(LastingDoubtTest, LastsAtMostUntilItsBound) {
  note(10'000, Sign::present);
  EXPECT_NEAR(note(10'000, Sign::absent) * kStep, FaultLatch::kMostSeconds, 3 * kStep);
}

TEST_F(LastingDoubtTest, DoesNotFlickerForAnIntermittentCause) {
  for (int i = 0; i < 50; ++i) {
    EXPECT_EQ(note(1, Sign::present), 1);
    EXPECT_EQ(note(9, Sign::absent), 9);
  }
}

TEST_F(LastingDoubtTest, IsNotEndedByUninformativeFrames) {
  note(1, Sign::present);
  EXPECT_EQ(note(1000, Sign::unclear), 1000);
}

TEST_F(LastingDoubtTest, IsNotEndedByAGapInTime) {
  note(1, Sign::present);
  EXPECT_EQ(note(1, Sign::absent, 3600.0), 1);
}

}  // namespace
}  // namespace byre
