#include "byre/geometry/perspective_three_point.h"

#include "byre/geometry/geometry_matchers.h"

#include <random>

#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Contains;
using testing::IsEmpty;
using Triple = std::array<Eigen::Vector3d, 3>;

struct Scene {
  Pose camera_from_world;
  Triple points_in_world;
  Triple bearings;
};

Scene seen_from(const Pose& camera_from_world, const Triple& points_in_camera) {
  Scene scene{camera_from_world, {}, {}};
  for (int i = 0; i < 3; ++i) {
    scene.points_in_world[i] = inverse(camera_from_world) * points_in_camera[i];
    scene.bearings[i] = points_in_camera[i].normalized();
  }
  return scene;
}

Scene random_scene(std::mt19937& random) {
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  const auto vector = [&] {
    const double x = unit(random), y = unit(random), z = unit(random);
    return Eigen::Vector3d(x, y, z);
  };
  Triple points_in_camera;
  for (Eigen::Vector3d& point : points_in_camera) point = vector() * 3.0 + Eigen::Vector3d(0.0, 0.0, 4.0);
  const Eigen::Vector3d rotation_vector = 2.0 * vector();
  return seen_from({rotation_exp(rotation_vector), 10.0 * vector()}, points_in_camera);
}

TEST(PerspectiveThreePoint, ReturnsAtMostFourPosesWithTheTrueOne) {
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    const Scene scene = random_scene(random);
    const std::vector<Pose> poses = perspective_three_point(scene.points_in_world, scene.bearings);
    EXPECT_LE(poses.size(), 4u);
    EXPECT_THAT(poses, Contains(PoseNear(scene.camera_from_world, 1e-6, 1e-6))) << "scene " << i;
  }
}

TEST(PerspectiveThreePoint, FitsTheBearingsInEveryPose) {
  std::mt19937 random(2);
  int ambiguous = 0;
  for (int i = 0; i < 500; ++i) {
    const Scene scene = random_scene(random);
    const std::vector<Pose> poses = perspective_three_point(scene.points_in_world, scene.bearings);
    ambiguous += poses.size() > 1;
    for (const Pose& camera_from_world : poses) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_THAT((camera_from_world * scene.points_in_world[k]).normalized(), PointNear(scene.bearings[k], 1e-6));
      }
    }
  }
  EXPECT_GT(ambiguous, 50);
}

TEST(PerspectiveThreePoint, ReturnsAllFourPosesOfASymmetricPyramid) {
  // Equal sides and equal angles: one upright and three tilted poses.
  const Scene scene = seen_from(
      {}, {Eigen::Vector3d(1.0, 0.0, 2.0), Eigen::Vector3d(-0.5, 0.75, 2.0), Eigen::Vector3d(-0.5, -0.75, 2.0)});
  const std::vector<Pose> poses = perspective_three_point(scene.points_in_world, scene.bearings);
  EXPECT_THAT(poses, testing::SizeIs(4));
  EXPECT_THAT(poses, Contains(PoseNear(Pose{}, 1e-9, 1e-9)));
}

TEST(PerspectiveThreePoint, IsIndependentOfTheScaleOfTheWorld) {
  for (const double scale : {1e-3, 1e3}) {
    const Scene scene = seen_from({rotation_exp({0.1, 0.2, 0.3}), scale * Eigen::Vector3d(1.0, 2.0, 3.0)},
                                  {scale * Eigen::Vector3d(1.0, 0.2, 3.0), scale * Eigen::Vector3d(-0.4, 0.7, 2.0),
                                   scale * Eigen::Vector3d(-0.5, -0.6, 4.0)});
    EXPECT_THAT(perspective_three_point(scene.points_in_world, scene.bearings),
                Contains(PoseNear(scene.camera_from_world, 1e-9 * scale, 1e-9)));
  }
}

TEST(PerspectiveThreePoint, IsEmptyForCollinearPoints) {
  const Scene scene =
      seen_from({}, {Eigen::Vector3d(-1.0, 0.5, 3.0), Eigen::Vector3d(0.0, 0.5, 3.0), Eigen::Vector3d(2.0, 0.5, 3.0)});
  EXPECT_THAT(perspective_three_point(scene.points_in_world, scene.bearings), IsEmpty());
}

TEST(PerspectiveThreePoint, IsEmptyForCoincidentPoints) {
  const Scene scene =
      seen_from({}, {Eigen::Vector3d(0.1, 0.5, 3.0), Eigen::Vector3d(0.1, 0.5, 3.0), Eigen::Vector3d(0.1, 0.5, 3.0)});
  EXPECT_THAT(perspective_three_point(scene.points_in_world, scene.bearings), IsEmpty());
}

TEST(PerspectiveThreePoint, IsEmptyForInconsistentBearings) {
  // One ray for two different points, and the third at a right angle: the depths would be negative.
  const Triple points = {Eigen::Vector3d(0.0, 0.0, 0.0), Eigen::Vector3d(1.0, 0.0, 0.0),
                         Eigen::Vector3d(0.0, 0.1, 0.0)};
  const Triple bearings = {Eigen::Vector3d(0.0, 0.0, 1.0), Eigen::Vector3d(0.0, 0.0, 1.0),
                           Eigen::Vector3d(1.0, 0.0, 0.0)};
  EXPECT_THAT(perspective_three_point(points, bearings), IsEmpty());
}

}  // namespace
}  // namespace byre
