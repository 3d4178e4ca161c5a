#include "byre/benchmark/demo/findings_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(PlanFigures, CountPositionsOfARunWithAMap) {
  DemoArm arm = ten_frames(Arm::hybrid);
  arm.moments[0].error.reset();
  arm.moments[1].verdict = Verdict::degraded;
  arm.moments[2].error = 0.5;
  const PlanFigures figures = plan_figures(arm);
  EXPECT_DOUBLE_EQ(figures.placed_share, 0.9);
  EXPECT_DOUBLE_EQ(figures.close_share, 0.8);
  EXPECT_DOUBLE_EQ(figures.trusted_share, 0.8);
  EXPECT_EQ(figures.wrong, 1);
  EXPECT_EQ(figures.found_s, arm.moments[2].time_s);
  EXPECT_EQ(figures.median_error, 0.01);
  EXPECT_FALSE(figures.aligned_median_error);
}

TEST(PlanFigures, GiveNoPlaceToARunWithoutAMap) {
  const PlanFigures figures = plan_figures(ten_frames(Arm::no_map));
  EXPECT_EQ(figures.placed_share, 0.0);
  EXPECT_EQ(figures.trusted_share, 0.0);
  EXPECT_FALSE(figures.found_s);
  EXPECT_FALSE(figures.median_error);
  EXPECT_EQ(figures.aligned_median_error, 0.01);
}

TEST(PlanFigures, AreEmptyWithoutPositions) {
  const PlanFigures figures = plan_figures({Arm::hybrid, {}, {}});
  EXPECT_EQ(figures.placed_share, 0.0);
  EXPECT_FALSE(figures.found_s);
}

}  // namespace
}  // namespace byre
