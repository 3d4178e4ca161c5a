#include "byre/benchmark/measures.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::DoubleEq;

TEST(RunSummary, ContainsMeanMedianAndWorst) {
  const auto summary = summarise_runs({0.5, 0.1, 0.3, 0.2}, false);
  ASSERT_TRUE(summary);
  EXPECT_EQ(summary->runs, 4);
  EXPECT_THAT(summary->mean, DoubleEq(0.275));
  EXPECT_THAT(summary->median, DoubleEq(0.25));
  EXPECT_THAT(summary->worst, DoubleEq(0.5));
}

TEST(RunSummary, UsesTheMinimumAsWorstIfMoreIsBetter) {
  EXPECT_THAT(summarise_runs({0.9, 1.0, 0.7}, true)->worst, DoubleEq(0.7));
}

TEST(RunSummary, CountsOnlyRunsWithTheFigure) {
  const auto summary = summarise_runs({std::nullopt, 3.0, 5.0}, false);
  EXPECT_EQ(summary->runs, 2);
  EXPECT_THAT(summary->mean, DoubleEq(4.0));
  EXPECT_FALSE(summarise_runs({std::nullopt, std::nullopt}, false));
  EXPECT_FALSE(summarise_runs(std::vector<Figure>(), false));
}

TEST(RunSummary, UsesOneFigurePerRun) {
  std::vector<BehaviourMeasures> runs(2);
  runs[0].losses = 1.0;
  runs[1].losses = 3.0;
  for (const Measure<BehaviourMeasures>& measure : behaviour_measures()) {
    const auto summary = summarise_runs(runs, measure);
    ASSERT_EQ(summary.has_value(), std::string(measure.key) == "losses") << measure.key;
    if (summary) {
      EXPECT_THAT(summary->worst, DoubleEq(3.0));
    }
  }
}

TEST(TrajectoryMeasures, HaveUniqueKeys) {
  std::set<std::string> keys;
  for (const Measure<TrajectoryMeasures>& measure : trajectory_measures()) keys.insert(measure.key);
  EXPECT_EQ(keys.size(), trajectory_measures().size());
}

}  // namespace
}  // namespace byre
