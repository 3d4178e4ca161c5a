#include "byre/map/plan/plan_scale.h"

#include "byre/map/plan/floor_plan_scene.h"

#include <cmath>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Eq;
using testing::Gt;
using testing::IsEmpty;
using testing::Lt;
using testing::Not;
using testing::Optional;

constexpr double kTooLarge = 1.016;  // metres in the map per metre on the plan
constexpr int kTrials = 100;

std::optional<PlanScaleDoubt> doubt_of(FloorPlanScene& scene, const std::vector<PlanCorrespondence>& correspondences) {
  return measure_scale(correspondences, scene.plane()).value().doubt;
}

TEST(PlanScale, IsExactForExactPicks) {
  FloorPlanScene scene(1, 1.0 / kTooLarge);
  const PlanScale scale = measure_scale(scene.correspondences(8), scene.plane()).value();
  EXPECT_NEAR(scale.plan_from_map * kTooLarge, 1.0, 1e-7);
  EXPECT_NEAR(scale.excess(), 0.016, 1e-7);
  EXPECT_THAT(scale.doubt, Eq(std::nullopt));
  EXPECT_TRUE(scale.differs_from_one());
}

TEST(PlanScale, IsWithinThreeSigmasForEightNoisyPicks) {
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    FloorPlanScene scene(seed, 1.0 / kTooLarge);
    const PlanScale scale = measure_scale(scene.correspondences(8, kPickNoise), scene.plane()).value();
    EXPECT_THAT(std::abs(std::log(scale.plan_from_map * kTooLarge)), Lt(3.0 * scale.sigma)) << "seed " << seed;
    EXPECT_THAT(scale.sigma, Lt(0.002)) << "seed " << seed;
    EXPECT_TRUE(scale.differs_from_one()) << "seed " << seed;
  }
}

// Mean squared normalised error.
TEST(PlanScale, EstimatesAConsistentSigma) {
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= 30 * kTrials; ++seed) {
    FloorPlanScene scene(seed, 1.0 / kTooLarge);
    const PlanScale scale = measure_scale(scene.correspondences(10, 0.05), scene.plane()).value();
    const double error = std::log(scale.plan_from_map * kTooLarge);
    sum += error * error / (scale.sigma * scale.sigma);
  }
  EXPECT_THAT(sum / (30 * kTrials), Gt(0.8));
  EXPECT_THAT(sum / (30 * kTrials), Lt(1.3));
}

TEST(PlanScale, RarelyDiffersFromOneForACorrectMap) {
  int alarms = 0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    FloorPlanScene scene(seed);
    const PlanScale scale = measure_scale(scene.correspondences(8, kPickNoise), scene.plane()).value();
    if (scale.differs_from_one()) ++alarms;
  }
  EXPECT_THAT(alarms, Lt(2));
}

TEST(PlanScale, IsRobustToAWrongPick) {
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    FloorPlanScene scene(seed, 1.0 / kTooLarge);
    auto correspondences = scene.correspondences(8, kPickNoise);
    correspondences[seed % 8].point_in_plan.x() += 1.0;
    const PlanScale scale = measure_scale(correspondences, scene.plane()).value();
    EXPECT_THAT(scale.doubt, Eq(std::nullopt)) << "seed " << seed;
    EXPECT_THAT(std::abs(std::log(scale.plan_from_map * kTooLarge)), Lt(4.0 * scale.sigma)) << "seed " << seed;
  }
}

TEST(PlanScale, IsDoubtedForFewerThanFourPicks) {
  FloorPlanScene scene;
  EXPECT_THAT(doubt_of(scene, scene.correspondences(3)), Optional(PlanScaleDoubt::few_points));
  EXPECT_THAT(doubt_of(scene, scene.correspondences(4)), Eq(std::nullopt));
}

TEST(PlanScale, IsDoubtedForASmallSpread) {
  FloorPlanScene scene(1, 1.0 / kTooLarge);
  auto correspondences = scene.correspondences(6);
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    const auto place = static_cast<double>(i);
    const Eigen::Vector3d in_a_corner(0.3 * place, 3.0 + std::fmod(place, 2.0), 2.0);
    correspondences[i].point_in_map = scene.in_map(in_a_corner);
    correspondences[i].point_in_plan = in_a_corner.head<2>();
  }
  EXPECT_THAT(doubt_of(scene, correspondences), Optional(PlanScaleDoubt::small_spread));
}

TEST(PlanScale, IsDoubtedForInconsistentPicks) {
  FloorPlanScene scene;
  EXPECT_THAT(doubt_of(scene, scene.correspondences(8, 2.0)), Optional(PlanScaleDoubt::disagreement));
}

TEST(PlanScale, IsDoubtedForAnImplausibleBaseline) {
  FloorPlanScene scene(1, 1.3);
  EXPECT_THAT(doubt_of(scene, scene.correspondences(8, kPickNoise)), Optional(PlanScaleDoubt::implausible));
}

TEST(PlanScale, DoesNotDifferFromOneIfDoubted) {
  EXPECT_TRUE((PlanScale{0.98, 0.001, std::nullopt}.differs_from_one()));
  EXPECT_FALSE((PlanScale{0.98, 0.01, std::nullopt}.differs_from_one()));
  EXPECT_FALSE((PlanScale{0.98, 0.001, PlanScaleDoubt::disagreement}.differs_from_one()));
}

TEST(PlanScale, ReportsARemedyForEachDoubt) {
  for (const PlanScaleDoubt doubt : {PlanScaleDoubt::few_points, PlanScaleDoubt::small_spread,
                                     PlanScaleDoubt::disagreement, PlanScaleDoubt::implausible}) {
    EXPECT_THAT(std::string(to_string(doubt)), Not(IsEmpty()));
  }
}

TEST(PlanScale, IsEmptyForLessThanTwoPositions) {
  FloorPlanScene scene;
  EXPECT_FALSE(measure_scale(scene.correspondences(1), scene.plane()).has_value());
}

}  // namespace
}  // namespace byre
