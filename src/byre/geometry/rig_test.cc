#include "byre/rig.h"

#include "byre/geometry/geometry_matchers.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

Rig stereo_rig() {
  return {
      .width = 752, .height = 480, .focal = 435.0, .cx = 367.5, .cy = 252.25, .baseline = 0.11, .body_from_camera = {}};
}

TEST(Rig, PlacesThePrincipalPointOnTheAxis) {
  const StereoPixel pixel = stereo_rig().project({0.0, 0.0, 4.35});
  EXPECT_THAT(pixel, PointNear(StereoPixel(367.5, 252.25, 11.0), 1e-12));
}

TEST(Rig, DisparityIsTheColumnDifferenceToTheRightCamera) {
  const Rig rig = stereo_rig();
  const Eigen::Vector3d point_in_left(0.7, -0.2, 2.5);
  const Eigen::Vector3d point_in_right = point_in_left - Eigen::Vector3d(rig.baseline, 0.0, 0.0);
  const StereoPixel pixel = rig.project(point_in_left);
  EXPECT_NEAR(pixel.z(), pixel.x() - rig.project(point_in_right).x(), 1e-12);
}

TEST(Rig, TriangulatesItsProjections) {
  const Eigen::Vector3d point_in_camera(0.7, -0.2, 2.5);
  EXPECT_THAT(stereo_rig().triangulate(stereo_rig().project(point_in_camera)), PointNear(point_in_camera, 1e-13));
}

TEST(Rig, RayPassesThroughThePoint) {
  const Eigen::Vector3d point_in_camera(-1.5, 0.4, 3.0);
  const Eigen::Vector3d ray = stereo_rig().ray(stereo_rig().project(point_in_camera).head<2>());
  EXPECT_THAT(3.0 * ray, PointNear(point_in_camera, 1e-13));
}

TEST(Rig, JacobianAgreesWithFiniteDifferences) {
  const Rig rig = stereo_rig();
  const Eigen::Vector3d point_in_camera(0.7, -0.2, 2.5);
  constexpr double kStep = 1e-5;
  StereoJacobian numeric;
  for (int i = 0; i < 3; ++i) {
    const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
    numeric.col(i) = (rig.project(point_in_camera + step) - rig.project(point_in_camera - step)) / (2.0 * kStep);
  }
  EXPECT_LT((rig.projection_jacobian(point_in_camera) - numeric).norm(), 1e-6);
}

TEST(Rig, IsMonocularWithoutABaseline) {
  Rig rig = stereo_rig();
  EXPECT_TRUE(rig.is_stereo());
  rig.baseline = 0.0;
  EXPECT_FALSE(rig.is_stereo());
  EXPECT_EQ(rig.project({0.3, 0.2, 2.0}).z(), 0.0);
}

TEST(Rig, ContainsItsBorderPixelsAndKeepsAMargin) {
  const Rig rig = stereo_rig();
  EXPECT_TRUE(rig.contains({0.0, 0.0}));
  EXPECT_TRUE(rig.contains({751.0, 479.0}));
  EXPECT_FALSE(rig.contains({751.1, 479.0}));
  EXPECT_FALSE(rig.contains({100.0, -0.1}));
  EXPECT_FALSE(rig.contains({9.0, 100.0}, 10.0));
  EXPECT_TRUE(rig.contains({10.0, 100.0}, 10.0));
}

}  // namespace
}  // namespace byre
