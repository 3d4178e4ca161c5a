#include "byre/viewer/ground.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"

#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

// Keyframes of a level camera looking along the world's x, z up, at the given places.
StoredMap map_of(const std::vector<Eigen::Vector3d>& places) {
  Eigen::Matrix3d camera_from_world;
  camera_from_world << 0.0, -1.0, 0.0, 0.0, 0.0, -1.0, 1.0, 0.0, 0.0;
  StoredMap stored;
  const int rig = stored.map.add_rig({752, 480, 400.0, 376.0, 240.0, 0.1, {}});
  for (const Eigen::Vector3d& place : places) {
    Keyframe keyframe;
    keyframe.frame.features = std::make_shared<const Features>(752, 480, std::vector<Keypoint>{},
                                                               std::vector<Descriptor>{}, std::vector<Patch>{});
    keyframe.rig = rig;
    keyframe.camera_from_world.rotation = Eigen::Quaterniond(camera_from_world);
    keyframe.camera_from_world.translation = -(keyframe.camera_from_world.rotation * place);
    stored.map.add_keyframe(keyframe);
  }
  return stored;
}

// Round trip along a rectangle, longer in y than in x, at a height that varies by `uneven`.
StoredMap round_trip(double height, double uneven) {
  std::vector<Eigen::Vector3d> places;
  for (int i = 0; i < 40; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / 40.0;
    places.emplace_back(5.0 * std::cos(angle), 20.0 * std::sin(angle), height + uneven * std::sin(3.0 * angle));
  }
  return map_of(places);
}

TEST(Ground, IsTheDrivingPlane) {
  const Ground ground = ground_of(round_trip(3.0, 0.0));
  EXPECT_TRUE(ground.is_level);
  EXPECT_TRUE(ground.is_metric);
  EXPECT_NEAR((ground.ground_from_map * Eigen::Vector3d(7.0, 8.0, 4.5)).z(), 1.5, 1e-6) << "height above it";
}

TEST(Ground, HasThePathsLongestDirectionAsX) {
  const Ground ground = ground_of(round_trip(3.0, 0.0));
  const Eigen::Vector3d far = ground.ground_from_map * Eigen::Vector3d(0.0, 20.0, 3.0);
  EXPECT_NEAR(std::abs(far.x()), 20.0, 1e-6);
  EXPECT_NEAR(far.y(), 0.0, 1e-6);
}

TEST(Ground, DoesNotMirrorTheMap) {
  const Similarity seen = ground_of(round_trip(3.0, 0.0)).ground_from_map;
  const Eigen::Vector3d x = seen.target_from_source.rotation * Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = seen.target_from_source.rotation * Eigen::Vector3d::UnitY();
  EXPECT_NEAR(x.cross(y).z(), 1.0, 1e-6);
}

TEST(Ground, IsNotLevelForAFlyingCamera) {
  EXPECT_FALSE(ground_of(round_trip(3.0, 4.0)).is_level);
}

TEST(Ground, ExistsForASingleKeyframe) {
  const Ground ground = ground_of(map_of({{1.0, 2.0, 3.0}}));
  EXPECT_THAT(ground.ground_from_map * Eigen::Vector3d(1.0, 2.0, 3.0), PointNear(Eigen::Vector3d::Zero(), 1e-9));
}

TEST(Ground, IsThePlanOfARegisteredMap) {
  StoredMap stored = round_trip(0.8, 0.0);
  stored.scale = MapScale::unknown;
  stored.plan = PlanRegistration{};
  stored.plan->plan_from_map = {2.0, {Eigen::Quaterniond::Identity(), {100.0, 200.0, 0.0}}};
  const Ground ground = ground_of(stored);
  EXPECT_THAT(ground.ground_from_map * Eigen::Vector3d(1.0, 2.0, 0.5),
              PointNear(Eigen::Vector3d(102.0, 204.0, 1.0), 1e-9));
  EXPECT_TRUE(ground.is_metric) << "the plan gives the scale";
  EXPECT_EQ(ground.image, nullptr);
}

TEST(Ground, IsInTheUnitOfAnUnscaledMap) {
  StoredMap stored = round_trip(0.8, 0.0);
  stored.scale = MapScale::unknown;
  EXPECT_FALSE(ground_of(stored).is_metric);
}

TEST(Ground, ReportsAnUnreadablePlanImage) {
  StoredMap stored = round_trip(0.8, 0.0);
  stored.plan = PlanRegistration{};
  FloorPlan plan;
  plan.image = "/nowhere/plan.png";
  EXPECT_THROW(ground_of(stored, plan), InputError);
}

}  // namespace
}  // namespace byre
