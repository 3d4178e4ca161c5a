#include "byre/slam/loops/loop_closing.h"

#include "byre/slam/loops/drift_scene.h"

#include <map>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Depths in two parts of a map, the newer one scaled, with noise of their sigma.
std::vector<DepthPair> pairs_of(int count, double new_per_old, double sigma, unsigned seed = 7) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> depth(1.0, 8.0);
  std::normal_distribution<double> noise(0.0, 1.0);
  std::vector<DepthPair> pairs;
  for (int i = 0; i < count; ++i) {
    const double older = depth(random);
    pairs.push_back({new_per_old * older * std::exp(sigma * noise(random)), older, std::max(sigma, 0.005)});
  }
  return pairs;
}

TEST(EstimateScaleDrift, IsExactOnCleanDepths) {
  const auto drift = estimate_scale_drift(pairs_of(20, 1.08, 0.0), 15);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->old_per_new, 1.0 / 1.08, 1e-12);
}

TEST(EstimateScaleDrift, EstimatesAConsistentSigma) {
  constexpr unsigned kTrials = 100;
  double sum = 0.0;  // squared errors, in sigmas: chi-square
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const auto drift = estimate_scale_drift(pairs_of(50, 0.9, 0.04, seed), 15);
    ASSERT_TRUE(drift);
    sum += std::pow(std::log(drift->old_per_new * 0.9) / drift->sigma, 2);
  }
  EXPECT_NEAR(sum / kTrials, 1.0, 0.4);
  EXPECT_NEAR(estimate_scale_drift(pairs_of(400, 0.9, 0.04), 15)->sigma, 0.04 / 20.0, 0.0005);
}

TEST(EstimateScaleDrift, RejectsFalseMatches) {
  std::vector<DepthPair> pairs = pairs_of(60, 1.05, 0.01);
  for (std::size_t i = 0; i < pairs.size(); i += 4) pairs[i].newer *= 3.0;
  const auto drift = estimate_scale_drift(pairs, 15);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->old_per_new, 1.0 / 1.05, 0.006);
}

TEST(EstimateScaleDrift, WeightsNearPointsMore) {
  std::vector<DepthPair> pairs = pairs_of(30, 1.0, 0.0);
  std::vector<DepthPair> uncertain = pairs_of(20, 1.3, 0.0);
  for (DepthPair& pair : uncertain) pair.sigma = 0.2;
  pairs.insert(pairs.end(), uncertain.begin(), uncertain.end());
  const auto drift = estimate_scale_drift(pairs, 15);
  ASSERT_TRUE(drift);
  EXPECT_NEAR(drift->old_per_new, 1.0, 0.002);
}

TEST(EstimateScaleDrift, IsEmptyForTooFewPoints) {
  EXPECT_FALSE(estimate_scale_drift(pairs_of(14, 1.1, 0.0), 15));
  EXPECT_FALSE(estimate_scale_drift({}, 1));
}

// Track of the newest keyframe on points of the first half of the lap, at its true pose.
TrackedFrame in_older_part(const DriftedLap& lap) {
  const Keyframe& keyframe = *lap.map.find_keyframe(lap.newest());
  std::map<int, PointId> older_points;
  for (const PointId id : lap.map.point_ids()) {
    if (lap.map.find_point(id)->reference.keyframe.number < 12) {
      older_points[true_landmark(lap.mission, lap.map, id)] = id;
    }
  }
  TrackedFrame tracked;
  tracked.camera_from_world = lap.true_pose(lap.newest());
  for (int feature = 0; feature < keyframe.frame.features->size(); ++feature) {
    const auto older = older_points.find(true_landmark(lap.mission, keyframe, feature));
    if (older != older_points.end()) tracked.features.push_back({feature, older->second, {}, 1.0f});
  }
  return tracked;
}

TEST(DepthPairs, AreThePointsOfBothParts) {
  const DriftedLap lap(monocular_rig(), {1.1, {}});
  const Keyframe& keyframe = *lap.map.find_keyframe(lap.newest());
  const TrackedFrame tracked = in_older_part(lap);
  const std::vector<DepthPair> pairs = depth_pairs(lap.map, keyframe, tracked);
  EXPECT_GT(pairs.size(), 50u);
  EXPECT_LT(pairs.size(), tracked.features.size()) << "some features have no point";
  for (const DepthPair& pair : pairs) {
    EXPECT_THAT(pair.newer / pair.older, testing::AllOf(testing::Ge(1.0), testing::Le(1.13)));
    EXPECT_GE(pair.sigma, 0.005);
  }
}

}  // namespace
}  // namespace byre
