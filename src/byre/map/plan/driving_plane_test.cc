#include "byre/map/plan/driving_plane.h"

#include "byre/geometry/degrees.h"
#include "byre/map/plan/floor_plan_scene.h"

#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::SizeIs;

double tilt_error(const DrivingPlane& plane, const FloorPlanScene& scene) {
  return std::acos(std::min(1.0, plane.up_in_map.dot(scene.up_of_rig_in_map())));
}

double tilt_sigma(const DrivingPlane& plane, const Eigen::Vector3d& direction_in_map) {
  return std::sqrt(direction_in_map.dot(plane.up_information.inverse() * direction_in_map));
}

TEST(DrivingPlane, IsThatOfThePathForAnyCameraOrientation) {
  FloorPlanScene scene;
  for (const double pitch : {-10.0, 0.0, 30.0, 60.0}) {
    const DrivingPlane plane =
        fit_driving_plane(scene.path_in_map(), scene.up_of_rig_in_map(5.0 * kDegree, pitch * kDegree));
    EXPECT_LT(tilt_error(plane, scene), 0.1 * kDegree) << pitch << " degrees down";
  }
}

TEST(DrivingPlane, IsFoundOnAnUnevenFloor) {
  FloorPlanScene scene;
  const DrivingPlane plane =
      fit_driving_plane(scene.path_in_map(4.0, 0.02), scene.up_of_rig_in_map(3.0 * kDegree, 5.0 * kDegree));
  EXPECT_LT(tilt_error(plane, scene), 0.3 * kDegree);
  EXPECT_NEAR(plane.thickness, 0.02, 0.005);
}

TEST(DrivingPlane, TakesTheRollAboutAStraightPathFromTheCamera) {
  FloorPlanScene scene;
  const DrivingPlane level = fit_driving_plane(scene.path_in_map(0.0), scene.up_of_rig_in_map(0.0, 20.0 * kDegree));
  EXPECT_LT(tilt_error(level, scene), 0.1 * kDegree);
  const DrivingPlane rolled = fit_driving_plane(scene.path_in_map(0.0), scene.up_of_rig_in_map(2.0 * kDegree));
  EXPECT_NEAR(tilt_error(rolled, scene), 2.0 * kDegree, 0.1 * kDegree);
}

TEST(DrivingPlane, EstimatesItsTiltSigma) {
  FloorPlanScene scene;
  const DrivingPlane plane = fit_driving_plane(scene.path_in_map(0.0), scene.up_of_rig_in_map());
  const Eigen::Vector3d along = (plane.path_in_map[30] - plane.path_in_map[0]).normalized();
  EXPECT_LT(tilt_sigma(plane, along), 0.1 * kDegree);
  EXPECT_GT(tilt_sigma(plane, along.cross(plane.up_in_map)), 2.0 * kDegree);
}

TEST(DrivingPlane, IsTakenFromTheCameraWithoutMotion) {
  const FloorPlanScene scene;
  const DrivingPlane plane = fit_driving_plane({Eigen::Vector3d(1.0, 2.0, 3.0)}, scene.up_of_rig_in_map());
  EXPECT_LT(tilt_error(plane, scene), 1e-9);
  EXPECT_EQ(plane.point_in_map, Eigen::Vector3d(1.0, 2.0, 3.0));
}

TEST(DrivingPlane, UsesTheBodyOfAMap) {
  FloorPlanScene scene;
  const std::vector<Eigen::Vector3d> path = scene.path_in_map(0.0);
  const std::optional<DrivingPlane> plane = fit_driving_plane(scene.driven_map(path), {});
  ASSERT_TRUE(plane.has_value());
  EXPECT_LT(tilt_error(*plane, scene), 1e-6);
  ASSERT_THAT(plane->path_in_map, SizeIs(path.size()));
  EXPECT_LT((plane->path_in_map.back() - path.back()).norm(), 1e-9);
}

TEST(DrivingPlane, IsEmptyWithoutKeyframesOrUpDirection) {
  EXPECT_FALSE(fit_driving_plane(MapGraph(Origin::offline), {}).has_value());
  MapGraph map(Origin::offline);
  map.add_rig({});
  for (const double turn : {0.0, std::numbers::pi}) {
    Keyframe keyframe;
    keyframe.camera_from_world.rotation = rotation_exp({turn, 0.0, 0.0});
    map.add_keyframe(keyframe);
  }
  EXPECT_FALSE(fit_driving_plane(map, {}).has_value());
}

}  // namespace
}  // namespace byre
