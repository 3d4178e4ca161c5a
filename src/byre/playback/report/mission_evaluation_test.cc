#include "byre/playback/report/mission_report.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

Trajectory curve(double offset) {
  Trajectory path;
  for (int i = 0; i < 5; ++i) {
    path.push_back({from_seconds(i), Pose{Eigen::Quaterniond::Identity(), {1.0 * i, 0.5 * i * i, offset}}});
  }
  return path;
}

TEST(JudgeMission, MeasuresErrorsGivenTruth) {
  RunResult run;
  run.causal = run.final = curve(0.0);
  EXPECT_FALSE(evaluate_mission(run, {}, std::nullopt, {}).errors.has_value());
  const MissionOutcome outcome = evaluate_mission(run, {}, MissionTruth{curve(2.0), {}, {}, Scale::fixed}, {});
  ASSERT_TRUE(outcome.errors.has_value());
  EXPECT_FALSE(outcome.errors->in_map_frame) << "there is no offline map";
  ASSERT_EQ(outcome.errors->final.size(), 5u);
  EXPECT_NEAR(position_statistics(outcome.errors->final).max, 0.0, 1e-9) << "the path was aligned";
}

}  // namespace
}  // namespace byre
