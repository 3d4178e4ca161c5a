#include "mission_score.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr double kInterval = 0.1;  // seconds

// The map's origin is 10 m from the truth's, and its axes are rotated.
Similarity truth_from_map() {
  return {1.0, {rotation_exp({0.0, 0.0, 0.7}), {10.0, 0.0, 0.0}}};
}

Pose true_pose(int i) {
  return {rotation_exp({0.1 * i, 0.0, 0.3}), {0.05 * i, 1.0, 0.0}};
}

// A pose with this error along the body's x axis, metres, and a standard deviation of 0.1 m.
MissionFrame frame(int i, Verdict verdict, double error) {
  MissionFrame frame;
  frame.report.time = from_seconds(kInterval * i);
  frame.report.health.verdict = verdict;
  const Pose off{Eigen::Quaterniond::Identity(), {error, 0.0, 0.0}};
  frame.report.map_from_body = inverse(truth_from_map().target_from_source) * true_pose(i) * off;
  frame.report.covariance = Matrix6::Identity() * 0.01;
  frame.true_world_from_body = true_pose(i);
  return frame;
}

std::vector<MissionFrame> frames(int count, Verdict verdict, double error) {
  std::vector<MissionFrame> result;
  for (int i = 0; i < count; ++i) result.push_back(frame(i, verdict, error));
  return result;
}

MissionScore score_of(const std::vector<MissionFrame>& mission, std::optional<Timestamp> undisturbed_from = {}) {
  return score(mission, truth_from_map(), undisturbed_from);
}

TEST(MissionScore, MeasuresInTheMapFrame) {
  const MissionScore score = score_of(frames(10, Verdict::trusted, 0.03));
  EXPECT_EQ(score.frames, 10);
  EXPECT_NEAR(score.rmse, 0.03, 1e-9);
  EXPECT_NEAR(score.worst_trusted_error, 0.03, 1e-9);
  EXPECT_EQ(score.coverage, 1.0);
  EXPECT_EQ(score.trusted, 1.0);
  EXPECT_EQ(score.longest_wrong_trust, 0.0);
}

TEST(MissionScore, DistinguishesPosesFromTrustedPoses) {
  std::vector<MissionFrame> mission = frames(10, Verdict::degraded, 0.0);
  mission[0].report.health.verdict = Verdict::trusted;
  mission[1].report.map_from_body.reset();
  EXPECT_DOUBLE_EQ(score_of(mission).coverage, 0.9);
  EXPECT_DOUBLE_EQ(score_of(mission).trusted, 0.1);
}

TEST(MissionScore, MeasuresTheLongestIntervalOfWrongTrust) {
  std::vector<MissionFrame> mission = frames(20, Verdict::trusted, 0.0);
  for (const int i : {3, 4, 10, 11, 12}) mission[static_cast<std::size_t>(i)] = frame(i, Verdict::trusted, 0.3);
  EXPECT_NEAR(score_of(mission).longest_wrong_trust, 0.3, 1e-9);
  EXPECT_NEAR(score_of(mission).worst_trusted_error, 0.3, 1e-9);
}

TEST(MissionScore, IgnoresAWrongUntrustedPose) {
  for (const Verdict verdict : {Verdict::degraded, Verdict::untrusted}) {
    const MissionScore score = score_of(frames(10, verdict, 5.0));
    EXPECT_EQ(score.longest_wrong_trust, 0.0);
    EXPECT_EQ(score.worst_trusted_error, 0.0);
    EXPECT_NEAR(score.rmse, 5.0, 1e-9);
  }
}

TEST(MissionScore, MeasuresRecoveryFromTheEndOfTheDisturbance) {
  std::vector<MissionFrame> mission = frames(20, Verdict::untrusted, 0.0);
  for (const int i : {0, 1, 15}) mission[static_cast<std::size_t>(i)].report.health.verdict = Verdict::trusted;
  EXPECT_NEAR(score_of(mission, from_seconds(1.0)).recovery.value(), 0.5, 1e-9);
  EXPECT_NEAR(score_of(mission, from_seconds(0.0)).recovery.value(), 0.0, 1e-9);
  EXPECT_FALSE(score_of(mission, from_seconds(1.6)).recovery);
  EXPECT_FALSE(score_of(mission).recovery);
}

TEST(MissionScore, CountsNothingAsCorrectOnAMapOfAnotherPlace) {
  const MissionScore score = byre::score(frames(10, Verdict::trusted, 0.0), std::nullopt, std::nullopt);
  EXPECT_TRUE(std::isinf(score.worst_trusted_error));
  EXPECT_NEAR(score.longest_wrong_trust, 0.9, 1e-9);
}

TEST(MissionScore, CountsErrorsInsideTheBoundOfTheirCovariance) {
  std::vector<MissionFrame> mission = frames(10, Verdict::trusted, 0.2);  // 2 sigma: inside in three dimensions
  mission[0] = frame(0, Verdict::degraded, 0.3);                          // 3 sigma
  mission[1] = frame(1, Verdict::untrusted, 0.3);                         // not counted
  EXPECT_NEAR(score_of(mission).within_bound, 8.0 / 9.0, 1e-9);
}

TEST(MissionScore, BoundsErrorsAlongTheBodyAxes) {
  MissionFrame along = frame(5, Verdict::trusted, 0.5);
  along.report.covariance.diagonal() << 1.0, 1e-4, 1e-4, 1e-4, 1e-4, 1e-4;
  MissionFrame across = along;
  across.report.covariance.diagonal() << 1e-4, 1.0, 1.0, 1e-4, 1e-4, 1e-4;
  EXPECT_EQ(score_of({along}).within_bound, 1.0);
  EXPECT_EQ(score_of({across}).within_bound, 0.0);
}

TEST(MissionScore, OmitsFramesWithoutTruth) {
  std::vector<MissionFrame> mission = frames(3, Verdict::trusted, 0.1);
  mission[1] = frame(1, Verdict::trusted, 9.0);
  mission[1].true_world_from_body.reset();
  EXPECT_NEAR(score_of(mission).rmse, 0.1, 1e-9);
  EXPECT_EQ(score_of(mission).longest_wrong_trust, 0.0);
}

}  // namespace
}  // namespace byre
