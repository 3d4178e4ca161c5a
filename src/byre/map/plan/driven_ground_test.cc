#include "byre/map/plan/driven_ground.h"

#include "byre/geometry/degrees.h"
#include "byre/map/plan/driven_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <gmock/gmock.h>

namespace byre {
namespace {

// The path of driven() with noise on each pose.
std::vector<Pose> shaken(double metres, double radians) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  std::vector<Pose> path = driven();
  for (Pose& body : path) {
    body = body * exp_pose((Vector6() << 0.0, 0.0, metres * normal(random), radians * normal(random),
                            radians * normal(random), 0.0)
                               .finished());
  }
  return path;
}

DrivenGround::GroundOffset offset(const DrivenGround& ground, const Pose& level_from_body) {
  return ground.offset_from_ground(kMapFromLevel * level_from_body);
}

TEST(DrivenGround, MeasuresHeightAndTiltOnALevelFloor) {
  const auto ground = DrivenGround::under(map_of(driven()));
  ASSERT_TRUE(ground);
  EXPECT_LT(ground->tilt_spread(), 0.5 * kDegree);
  Pose body = on_floor(14.2, 0.9, 1.0);
  EXPECT_NEAR(offset(*ground, body).height, 0.0, 0.005);
  EXPECT_LT(offset(*ground, body).tilt, 0.5 * kDegree);
  body.translation.z() = -0.8;
  EXPECT_NEAR(offset(*ground, body).height, -0.8, 0.01);
  body.rotation = rotation_exp({0.0, 0.2, 0.0}) * body.rotation;
  EXPECT_NEAR(offset(*ground, body).tilt, 0.2, 0.5 * kDegree);
  EXPECT_LT(offset(*ground, body).height_sigma, 0.03);
}

TEST(DrivenGround, IsLessCertainInHeightFarFromThePath) {
  const auto ground = DrivenGround::under(map_of(driven()));
  ASSERT_TRUE(ground);
  EXPECT_GT(offset(*ground, on_floor(14.0, 12.0, 0.0)).height_sigma,
            offset(*ground, on_floor(14.0, 3.0, 0.0)).height_sigma);
}

TEST(DrivenGround, FindsTheNearestPathPositionAtAnyDistance) {
  const std::vector<Pose> path = driven();
  const auto ground = DrivenGround::under(map_of(path));
  ASSERT_TRUE(ground);
  for (const double y : {1.0, -2.9, -3.0, -3.1, 4.9, 5.0, 5.1, 8.0, 300.0}) {
    for (const double x : {-20.0, -3.0, 0.1, 7.3, 29.0, 32.9, 60.0}) {
      const Pose body = on_floor(x, y, 0.0);
      double nearest = 1e9;
      for (const Pose& place : path) nearest = std::min(nearest, (place.translation - body.translation).norm());
      EXPECT_NEAR(offset(*ground, body).distance, nearest, 1e-9) << x << ", " << y;
    }
  }
}

TEST(DrivenGround, FollowsRamps) {
  const double slope = std::tan(8.0 * kDegree);
  const auto ground = DrivenGround::under(map_of(driven(slope)));
  ASSERT_TRUE(ground);
  for (const double x : {2.0, 9.0, 11.0, 13.0, 15.0, 20.0, 28.0}) {
    const auto there = offset(*ground, on_floor(x, 1.0, 0.0, slope));
    EXPECT_LT(std::abs(there.height), 0.15) << x;
    EXPECT_LT(there.tilt, 5.0 * kDegree) << x;
  }
  EXPECT_GT(offset(*ground, on_floor(20.0, 1.0, 0.0)).height, -0.9);
  EXPECT_LT(offset(*ground, on_floor(20.0, 1.0, 0.0)).height, -0.8) << "under the upper floor";
}

TEST(DrivenGround, IsFoundForMapsOfSlightlyShakingWheels) {
  EXPECT_TRUE(DrivenGround::under(map_of(shaken(0.01, 0.01))));
}

TEST(DrivenGround, IsNotFoundForHandheldOrFlownMaps) {
  EXPECT_FALSE(DrivenGround::under(map_of(shaken(0.02, 0.05)))) << "tilted in the hand";
  EXPECT_FALSE(DrivenGround::under(map_of(shaken(0.1, 0.01)))) << "held up and down";
  std::vector<Pose> flown = driven();
  for (std::size_t i = 0; i < flown.size(); ++i)
    flown[i].translation.z() = 0.5 * std::sin(0.7 * static_cast<double>(i));
  EXPECT_FALSE(DrivenGround::under(map_of(flown)));
}

// The camera looks to the left of the way and down, so that its images tilt about a straight way.
TEST(DrivenGround, IsNormalToTheUpAxisOfTheBaseWhereThePathIsALine) {
  std::vector<Pose> path;
  for (int i = 0; i < 60; ++i) path.push_back(on_floor(0.5 * i, 0.0, std::numbers::pi / 2.0));
  const auto by_images = DrivenGround::under(map_of(path));
  const auto by_base = DrivenGround::under(map_of(path), UpInBody{Eigen::Vector3d::UnitZ(), 2.0 * kDegree});
  ASSERT_TRUE(by_images && by_base);
  const Pose beside = on_floor(15.0, 2.0, std::numbers::pi / 2.0);
  EXPECT_GT(std::abs(offset(*by_images, beside).height), 0.5);
  EXPECT_NEAR(offset(*by_base, beside).height, 0.0, 0.005);
  EXPECT_LT(offset(*by_base, on_floor(15.0, 2.0, 0.3)).tilt, 0.1 * kDegree);
  EXPECT_NEAR(offset(*by_base, beside).height_sigma, 2.0 * 2.0 * kDegree, 0.01) << "by the sigma of the base";
}

TEST(DrivenGround, IsRefinedByThePathWhereTheBaseIsGivenAFewDegreesOff) {
  const Eigen::Vector3d given = rotation_exp({2.0 * kDegree, -2.0 * kDegree, 0.0}) * Eigen::Vector3d::UnitZ();
  const auto ground = DrivenGround::under(map_of(driven()), UpInBody{given, 2.0 * kDegree});
  ASSERT_TRUE(ground);
  EXPECT_LT(offset(*ground, on_floor(14.2, 0.9, 1.0)).tilt, 0.5 * kDegree);
  EXPECT_NEAR(offset(*ground, on_floor(14.2, 0.9, 1.0)).height, 0.0, 0.005);
}

TEST(DrivenGround, IsFoundForShortMapsByTheBase) {
  const auto path = driven();
  const auto ground = DrivenGround::under(map_of(std::vector<Pose>(path.begin(), path.begin() + 3)),
                                          UpInBody{Eigen::Vector3d::UnitZ(), 1.0 * kDegree});
  ASSERT_TRUE(ground);
  EXPECT_LT(offset(*ground, path[1]).tilt, 0.1 * kDegree);
  EXPECT_FALSE(DrivenGround::under(MapGraph(Origin::offline), UpInBody{}));
}

TEST(DrivenGround, IsNotFoundForShortMaps) {
  std::vector<Pose> path = driven();
  path.resize(10);
  EXPECT_FALSE(DrivenGround::under(map_of(path)));
  EXPECT_FALSE(DrivenGround::under(map_of(std::vector<Pose>(40, path.front()))));
  EXPECT_FALSE(DrivenGround::under(MapGraph(Origin::offline)));
}

}  // namespace
}  // namespace byre
