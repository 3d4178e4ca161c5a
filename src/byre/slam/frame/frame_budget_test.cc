#include "byre/slam/frame/frame_budget.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// Frames with given times of their stages, by a simulated clock.
class FrameBudgetTest : public testing::Test {
 protected:
  static constexpr double kDeadline = 0.020;

  // Seconds of the stages without cuts.
  struct Times {
    double images = 0.005;
    double tracking = 0.003;
    double rest = 0.001;
  };

  void process(const Times& times, bool is_tracked = true) {
    constexpr double kShareOfLeftImage = 0.5;
    constexpr double kShareOfOffline = 0.5;
    budget_.begin();
    now_ += times.images * (budget_.has_time_for_right_image() ? 1.0 : kShareOfLeftImage);
    now_ += times.tracking * (budget_.begin_tracking().online_points ? kShareOfOffline : 1.0);
    if (is_tracked) budget_.note_tracked();
    now_ += times.rest;
    budget_.end();
  }

  double now_ = 100.0;
  FrameBudget budget_{kDeadline, [this] { return now_; }};
};

TEST_F(FrameBudgetTest, CutsNothingWhileFramesAreOnTime) {
  for (int i = 0; i < 100; ++i) {
    process({});
    EXPECT_FALSE(budget_.cuts().online_points);
    EXPECT_FALSE(budget_.cuts().right_image);
    EXPECT_FALSE(budget_.is_late());
  }
}

TEST_F(FrameBudgetTest, CutsOnlinePointsFirst) {
  for (int i = 0; i < 20; ++i) process({.images = 0.010, .tracking = 0.012, .rest = 0.001});
  EXPECT_TRUE(budget_.cuts().online_points);
  EXPECT_FALSE(budget_.cuts().right_image);
  EXPECT_FALSE(budget_.is_late());
}

TEST_F(FrameBudgetTest, CutsTheRightImageNext) {
  for (int i = 0; i < 20; ++i) process({.images = 0.018, .tracking = 0.008, .rest = 0.002});
  EXPECT_TRUE(budget_.cuts().online_points || budget_.cuts().right_image);
  EXPECT_TRUE(budget_.cuts().right_image);
  EXPECT_FALSE(budget_.is_late());
}

TEST_F(FrameBudgetTest, CutsOnlinePointsAfterSlowImageProcessing) {
  for (int i = 0; i < 20; ++i) process({});
  process({.images = 0.017, .tracking = 0.003, .rest = 0.001});
  EXPECT_TRUE(budget_.cuts().online_points);
  EXPECT_FALSE(budget_.is_late());
}

TEST_F(FrameBudgetTest, ReportsLateFramesDespiteCuts) {
  process({.images = 0.050, .tracking = 0.003, .rest = 0.001});
  EXPECT_TRUE(budget_.is_late());
}

TEST_F(FrameBudgetTest, RetriesWholeFramesOnceTheMachineIsFree) {
  for (int i = 0; i < 50; ++i) process({.images = 0.018, .tracking = 0.008, .rest = 0.002});
  int with_cuts = 0;
  for (int i = 0; i < 600; ++i) {
    process({});
    with_cuts += budget_.cuts().online_points || budget_.cuts().right_image ? 1 : 0;
  }
  EXPECT_GT(with_cuts, 0);
  EXPECT_LT(with_cuts, 300);
  EXPECT_FALSE(budget_.cuts().online_points);
  EXPECT_FALSE(budget_.cuts().right_image);
}

TEST_F(FrameBudgetTest, IsRarelyLateDueToRetries) {
  int late = 0;
  for (int i = 0; i < 1000; ++i) {
    process({.images = 0.010, .tracking = 0.015, .rest = 0.001});
    late += i >= 20 && budget_.is_late() ? 1 : 0;
  }
  EXPECT_LE(late, 10);
}

TEST_F(FrameBudgetTest, KeepsTheNextFrameWholeOnRequest) {
  for (int i = 0; i < 20; ++i) process({.images = 0.018, .tracking = 0.008, .rest = 0.002});
  budget_.keep_next_whole();
  process({.images = 0.018, .tracking = 0.008, .rest = 0.002});
  EXPECT_FALSE(budget_.cuts().online_points);
  EXPECT_FALSE(budget_.cuts().right_image);
  process({.images = 0.018, .tracking = 0.008, .rest = 0.002});
  EXPECT_TRUE(budget_.cuts().right_image);
}

TEST_F(FrameBudgetTest, ExcludesGlobalSearchesFromTheTrackingTime) {
  for (int i = 0; i < 20; ++i) process({});
  for (int i = 0; i < 20; ++i) process({.images = 0.005, .tracking = 0.060, .rest = 0.001}, false);
  process({});
  EXPECT_FALSE(budget_.cuts().online_points);
}

TEST_F(FrameBudgetTest, CutsNothingWithoutADeadline) {
  budget_ = FrameBudget(0.0, [this] { return now_; });
  for (int i = 0; i < 20; ++i) process({.images = 1.0, .tracking = 1.0, .rest = 1.0});
  EXPECT_FALSE(budget_.cuts().online_points);
  EXPECT_FALSE(budget_.cuts().right_image);
  EXPECT_FALSE(budget_.is_late());
}

}  // namespace
}  // namespace byre
