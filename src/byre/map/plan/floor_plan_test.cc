#include "byre/map/plan/floor_plan.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/plan/floor_plan_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

std::vector<std::string> outliers_of(const std::vector<PlanCorrespondence>& correspondences, const PlanFit& fit) {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    if (fit.residuals[i].is_outlier) names.push_back(correspondences[i].name);
  }
  return names;
}

std::vector<PlanDoubt> doubts_of(FloorPlanScene& scene, const std::vector<PlanCorrespondence>& correspondences) {
  return register_on_plan(correspondences, scene.plane(), Scale::fixed)->doubts;
}

TEST(FloorPlan, IsRegisteredExactlyFromSixExactPicks) {
  FloorPlanScene scene;
  const auto fit = register_on_plan(scene.correspondences(6), scene.plane(), Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  EXPECT_EQ(fit->registration.plan_from_map.scale, 1.0);
  EXPECT_THAT(fit->registration.plan_from_map.target_from_source,
              PoseNear(scene.plan_from_map.target_from_source, 1e-6, 1e-7));
  EXPECT_LT(fit->rms, 1e-6);
  EXPECT_THAT(fit->doubts, IsEmpty());
}

// Largest values over trials, recorded in the file of --gtest_output=json:FILE.
class Worst {
 public:
  explicit Worst(const char* name) : name_(name) {}
  ~Worst() { testing::Test::RecordProperty(name_, std::to_string(value_)); }
  void add(double value) { value_ = std::max(value_, value); }

 private:
  const char* name_;
  double value_ = 0.0;
};

// With the path noise of SLAM and a slightly tilted camera.
TEST(FloorPlan, ErrsByLessThanACentimetreWithExactPicksOnARealPath) {
  Worst metres("worst_position_error_m");
  Worst degrees("worst_rotation_error_deg");
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    FloorPlanScene scene(seed);
    const DrivingPlane plane =
        fit_driving_plane(scene.path_in_map(3.0, 0.005), scene.up_of_rig_in_map(1.0 * kDegree, 3.0 * kDegree));
    const auto fit = register_on_plan(scene.correspondences(6), plane, Scale::fixed);
    ASSERT_TRUE(fit.has_value());
    EXPECT_THAT(fit->registration.plan_from_map.target_from_source,
                PoseNear(scene.plan_from_map.target_from_source, 0.01, 0.1 * kDegree));
    const Pose& estimate = fit->registration.plan_from_map.target_from_source;
    const Pose& truth = scene.plan_from_map.target_from_source;
    metres.add((estimate.translation - truth.translation).norm());
    degrees.add(angle_between(estimate.rotation, truth.rotation) / kDegree);
    EXPECT_LT(scene.worst_error(fit->registration.plan_from_map), 0.02);
  }
}

TEST(FloorPlan, ErrsByLessThanFiveCentimetresWithNoisyPicks) {
  Worst on_path("worst_path_error_m");
  Worst in_corner("worst_corner_error_m");
  double sum_in_corners = 0.0;
  constexpr int kTrials = 100;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    FloorPlanScene scene(seed);
    const auto fit = register_on_plan(scene.correspondences(6, kPickNoise), scene.plane(), Scale::fixed);
    ASSERT_TRUE(fit.has_value());
    const double path_error = scene.path_error(fit->registration.plan_from_map);
    const double corner_error = scene.worst_error(fit->registration.plan_from_map);
    EXPECT_LT(path_error, 0.05) << "seed " << seed;
    on_path.add(path_error);
    in_corner.add(corner_error);
    sum_in_corners += corner_error;
  }
  EXPECT_LT(sum_in_corners / kTrials, 0.04) << "metres, in the worst corner of the barn";
}

TEST(FloorPlan, ReportsOneWrongPickOfEight) {
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    FloorPlanScene scene(seed);
    auto correspondences = scene.correspondences(8, kPickNoise);
    const std::size_t wrong = seed % 8;
    const double direction = 0.7 * static_cast<double>(seed);
    correspondences[wrong].point_in_plan += Eigen::Vector2d(std::cos(direction), std::sin(direction));
    const auto fit = register_on_plan(correspondences, scene.plane(), Scale::fixed);
    ASSERT_TRUE(fit.has_value());
    EXPECT_THAT(outliers_of(correspondences, *fit), ElementsAre(correspondences[wrong].name)) << "seed " << seed;
    EXPECT_NEAR(fit->residuals[wrong].error_in_plan.norm(), 1.0, 0.2);
    EXPECT_LT(scene.worst_error(fit->registration.plan_from_map), 0.08) << "seed " << seed;
    EXPECT_THAT(fit->doubts, IsEmpty());
  }
}

TEST(FloorPlan, IsRegisteredDespiteThreeSwappedPicksOfEight) {
  FloorPlanScene scene;
  auto correspondences = scene.correspondences(8, kPickNoise);
  std::swap(correspondences[1].point_in_plan, correspondences[5].point_in_plan);
  correspondences[2].point_in_plan.y() += 7.0;
  const auto fit = register_on_plan(correspondences, scene.plane(), Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  EXPECT_THAT(outliers_of(correspondences, *fit), ElementsAre("sign 1", "sign 2", "sign 5"));
  EXPECT_LT(scene.worst_error(fit->registration.plan_from_map), 0.08);
  EXPECT_THAT(fit->doubts, ElementsAre(PlanDoubt::disagreement)) << "three of eight are too many outliers";
}

TEST(FloorPlan, ProvidesTheScaleOfANonMetricMap) {
  FloorPlanScene scene(1, 3.7);
  const auto exact = register_on_plan(scene.correspondences(6), scene.plane(), Scale::free);
  ASSERT_TRUE(exact.has_value());
  EXPECT_NEAR(exact->registration.plan_from_map.scale, 3.7, 1e-6);
  EXPECT_LT(scene.worst_error(exact->registration.plan_from_map), 1e-5);

  auto correspondences = scene.correspondences(8, kPickNoise);
  correspondences[3].point_in_plan.x() += 1.5;
  const auto fit = register_on_plan(correspondences, scene.plane(), Scale::free);
  ASSERT_TRUE(fit.has_value());
  EXPECT_THAT(outliers_of(correspondences, *fit), ElementsAre("sign 3"));
  EXPECT_NEAR(fit->registration.plan_from_map.scale, 3.7, 0.02);
  EXPECT_GT(fit->registration.covariance(6, 6), 0.0);
}

TEST(FloorPlan, KeepsPrecisionInAProjectedCoordinateSystem) {
  FloorPlanScene scene;
  auto correspondences = scene.correspondences(6);
  const Eigen::Vector2d offset(500000.0, 5400000.0);
  const auto near = register_on_plan(correspondences, scene.plane(), Scale::fixed);
  for (PlanCorrespondence& each : correspondences) each.point_in_plan += offset;
  const auto far = register_on_plan(correspondences, scene.plane(), Scale::fixed);
  ASSERT_TRUE(near && far);
  Pose expected = near->registration.plan_from_map.target_from_source;
  expected.translation.head<2>() += offset;
  EXPECT_THAT(far->registration.plan_from_map.target_from_source, PoseNear(expected, 1e-6, 1e-9));
  EXPECT_TRUE(far->registration.covariance.isApprox(near->registration.covariance, 1e-6));
}

TEST(FloorPlan, IsRaisedByTheHeightOfTheBody) {
  FloorPlanScene scene;
  PlanRegistrationOptions options;
  options.body_height = 0.4;
  const auto fit = register_on_plan(scene.correspondences(6), scene.plane(), Scale::fixed, options);
  ASSERT_TRUE(fit.has_value());
  EXPECT_NEAR((fit->registration.plan_from_map * scene.path_in_map()[5]).z(), 0.4, 1e-6);
}

TEST(FloorPlan, TakesTheTiltOfAStraightPathFromPicksOfManyHeights) {
  FloorPlanScene scene;
  auto correspondences = scene.correspondences(12);
  const DrivingPlane plane = fit_driving_plane(scene.path_in_map(0.0), scene.up_of_rig_in_map(3.0 * kDegree));
  const auto fit = register_on_plan(correspondences, plane, Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  EXPECT_THAT(outliers_of(correspondences, *fit), IsEmpty());
  EXPECT_THAT(fit->registration.plan_from_map.target_from_source,
              PoseNear(scene.plan_from_map.target_from_source, 0.1, 1.0 * kDegree));
}

// Mean squared normalised error of a corner; two coordinates.
TEST(FloorPlan, EstimatesAConsistentCovariance) {
  constexpr int kTrials = 300;
  const Eigen::Vector3d corner(40.0, 6.0, 0.0);
  double sum = 0.0;
  for (std::uint64_t seed = 1; seed <= kTrials; ++seed) {
    FloorPlanScene scene(seed);
    const auto fit = register_on_plan(scene.correspondences(10, 0.05), scene.plane(), Scale::fixed);
    ASSERT_TRUE(fit.has_value());
    const Eigen::Vector3d corner_in_map = scene.in_map(corner);
    const Eigen::Vector2d error = (fit->registration.plan_from_map * corner_in_map - corner).head<2>();
    sum += error.dot(plan_covariance_at(fit->registration, corner_in_map).inverse() * error);
  }
  EXPECT_GT(sum / kTrials, 1.4);
  EXPECT_LT(sum / kTrials, 2.8);
}

TEST(FloorPlan, IsLessCertainWithLargerResiduals) {
  FloorPlanScene scene;
  const auto good = register_on_plan(scene.correspondences(12, 0.03), scene.plane(), Scale::fixed);
  const auto poor = register_on_plan(scene.correspondences(12, 0.3), scene.plane(), Scale::fixed);
  ASSERT_TRUE(good && poor);
  const Eigen::Vector3d centre_in_map = scene.in_map({20.0, 0.0, 0.0});
  EXPECT_GT(plan_covariance_at(poor->registration, centre_in_map).trace(),
            20.0 * plan_covariance_at(good->registration, centre_in_map).trace());
}

// A wall between two points of the floor, picked at other points of its line on the plan.
PlanCorrespondence wall_of(const FloorPlanScene& scene, const Eigen::Vector2d& start, const Eigen::Vector2d& end) {
  const Eigen::Vector2d along = end - start;
  PlanCorrespondence wall{"wall", scene.in_map({start.x(), start.y(), 0.0}), start + 0.3 * along};
  wall.wall = PlanWall{scene.in_map({end.x(), end.y(), 0.0}), Eigen::Matrix3d::Zero(), start + 0.8 * along};
  return wall;
}

TEST(FloorPlan, IsRegisteredByWallsAndFewPoints) {
  FloorPlanScene scene;
  const auto sign = scene.correspondences(1).front();
  const PlanCorrespondence south = wall_of(scene, {3.0, -6.0}, {9.0, -6.0});
  const PlanCorrespondence north = wall_of(scene, {25.0, 6.0}, {19.0, 6.0});
  const PlanCorrespondence west = wall_of(scene, {0.0, -4.0}, {0.0, 4.0});
  for (const auto& picks : {std::vector{south, north, west}, std::vector{south, west, sign}, std::vector{sign, west}}) {
    const auto fit = register_on_plan(picks, scene.plane(), Scale::fixed);
    ASSERT_TRUE(fit.has_value());
    EXPECT_LT(scene.worst_error(fit->registration.plan_from_map), 1e-5);
    EXPECT_LT(fit->rms, 1e-6);
  }
  EXPECT_FALSE(register_on_plan(std::vector{south, north}, scene.plane(), Scale::fixed)) << "parallel";
}

TEST(FloorPlan, ReportsAWrongWall) {
  FloorPlanScene scene;
  auto picks = scene.correspondences(5, kPickNoise);
  picks.push_back(wall_of(scene, {3.0, -6.0}, {9.0, -6.0}));
  picks.push_back(wall_of(scene, {0.0, -4.0}, {0.0, 4.0}));
  picks[6].name = "wrong wall";
  picks[6].point_in_plan.x() += 0.6;
  picks[6].wall->end_in_plan.x() += 0.6;
  const auto fit = register_on_plan(picks, scene.plane(), Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  EXPECT_THAT(outliers_of(picks, *fit), ElementsAre("wrong wall"));
  EXPECT_NEAR(fit->residuals[6].error_in_plan.x(), -0.6, 0.08);
  EXPECT_NEAR(fit->residuals[6].error_in_plan.y(), 0.0, 1e-9);
}

// Points with errors of 0.5 m along the barn, where their covariance is as large.
TEST(FloorPlan, WeighsPicksByTheirCovariance) {
  FloorPlanScene scene;
  auto picks = scene.correspondences(6);
  const Eigen::Vector3d along = scene.in_map({1.0, 0.0, 0.0}) - scene.in_map({0.0, 0.0, 0.0});
  for (std::size_t i = 0; i < picks.size(); ++i) {
    if (i % 2 == 0) continue;
    picks[i].point_in_map += (i == 3 ? -0.5 : 0.5) * along;
    picks[i].covariance_in_map = 0.25 * along * along.transpose();
  }
  const auto fit = register_on_plan(picks, scene.plane(), Scale::fixed);
  ASSERT_TRUE(fit.has_value());
  EXPECT_THAT(outliers_of(picks, *fit), IsEmpty());
  EXPECT_LT(scene.worst_error(fit->registration.plan_from_map), 0.01);
  EXPECT_NEAR(fit->residuals[1].sigma, std::sqrt(0.05 * 0.05 + 0.125), 1e-3);
}

TEST(FloorPlan, IsEmptyForLessThanTwoPositions) {
  FloorPlanScene scene;
  EXPECT_FALSE(register_on_plan({}, scene.plane(), Scale::fixed).has_value());
  EXPECT_FALSE(register_on_plan(scene.correspondences(1), scene.plane(), Scale::fixed).has_value());
  const std::vector<PlanCorrespondence> twice(3, scene.correspondences(1).front());
  EXPECT_FALSE(register_on_plan(twice, scene.plane(), Scale::fixed).has_value());
  EXPECT_FALSE(register_on_plan(twice, scene.plane(), Scale::free).has_value());
}

TEST(FloorPlan, IsDoubtedForTwoPicks) {
  FloorPlanScene scene;
  EXPECT_THAT(doubts_of(scene, scene.correspondences(2)), ElementsAre(PlanDoubt::few_points));
}

TEST(FloorPlan, IsDoubtedForCollinearPicks) {
  FloorPlanScene scene;
  auto correspondences = scene.correspondences(6);
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    const Eigen::Vector3d on_the_line(4.0 + 6.0 * static_cast<double>(i), 1.0, 2.0);
    correspondences[i].point_in_map = scene.in_map(on_the_line);
    correspondences[i].point_in_plan = on_the_line.head<2>();
  }
  EXPECT_THAT(doubts_of(scene, correspondences), ElementsAre(PlanDoubt::in_line));
}

TEST(FloorPlan, IsDoubtedForPicksInACorner) {
  FloorPlanScene scene;
  auto correspondences = scene.correspondences(6);
  for (std::size_t i = 0; i < correspondences.size(); ++i) {
    const auto place = static_cast<double>(i);
    const Eigen::Vector3d in_the_corner(0.5 * place, 3.0 + 3.0 * std::fmod(place, 2.0), 2.0);
    correspondences[i].point_in_map = scene.in_map(in_the_corner);
    correspondences[i].point_in_plan = in_the_corner.head<2>();
  }
  EXPECT_THAT(doubts_of(scene, correspondences), ElementsAre(PlanDoubt::in_a_corner));
}

TEST(FloorPlan, IsDoubtedForInconsistentPicks) {
  FloorPlanScene scene;
  EXPECT_THAT(doubts_of(scene, scene.correspondences(8, 2.0)), Contains(PlanDoubt::disagreement));
  FloorPlanScene of_other_scale(1, 1.2);
  EXPECT_THAT(doubts_of(of_other_scale, of_other_scale.correspondences(8)), Contains(PlanDoubt::disagreement));
}

TEST(FloorPlan, IsDoubtedForANonPlanarPath) {
  FloorPlanScene scene;
  const auto correspondences = scene.correspondences(6);
  const DrivingPlane flight = fit_driving_plane(scene.path_in_map(10.0, 2.0), scene.up_of_rig_in_map());
  EXPECT_THAT(register_on_plan(correspondences, flight, Scale::fixed)->doubts, ElementsAre(PlanDoubt::uneven_path));
}

TEST(FloorPlan, ReportsARemedyForEachDoubt) {
  for (const PlanDoubt doubt : {PlanDoubt::few_points, PlanDoubt::in_line, PlanDoubt::in_a_corner,
                                PlanDoubt::disagreement, PlanDoubt::uneven_path}) {
    EXPECT_THAT(std::string(to_string(doubt)), Not(IsEmpty()));
  }
}

PlanFit fit_with(int inliers, int outliers) {
  PlanFit fit;
  for (int i = 0; i < inliers; ++i) fit.residuals.push_back({{0.03, 0.04}, false});
  for (int i = 0; i < outliers; ++i) fit.residuals.push_back({{3.0, 4.0}, true});
  fit.rms = 0.05;
  return fit;
}

TEST(ResidualOf, IncludesOutliersIfTheyMayBeRight) {
  EXPECT_EQ(residual_of(fit_with(6, 0)), 0.05);
  EXPECT_EQ(residual_of(fit_with(6, 2)), 0.05) << "two of eight are identified as outliers";
  EXPECT_FALSE(has_large_residual(fit_with(6, 2)));
  EXPECT_NEAR(residual_of(fit_with(2, 1)), std::sqrt((25.0 + 2 * 0.0025) / 3.0), 1e-12)
      << "one of three is not identified";
  EXPECT_NEAR(residual_of(fit_with(3, 3)), std::sqrt((25.0 + 0.0025) / 2.0), 1e-12);
  EXPECT_TRUE(has_large_residual(fit_with(3, 3)));
}

}  // namespace
}  // namespace byre
