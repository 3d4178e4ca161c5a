#include "byre/optimise/reprojection.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/optimise_scene.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(Reprojection, HasTheNumericJacobian) {
  constexpr double kStep = 1e-6;
  for (const double disparity_sigma : {0.3, -1.0}) {
    const Reprojection reprojection(stereo_rig(), {400.0, 100.0, 20.0}, 0.7, disparity_sigma);
    for (const double depth : {5.0, 0.3, 0.005, -0.5}) {
      const Eigen::Vector3d point_in_camera(0.4, -0.7, depth);
      Eigen::Matrix3d numeric;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(i);
        numeric.col(i) =
            (reprojection.residual(point_in_camera + step) - reprojection.residual(point_in_camera - step)) /
            (2.0 * kStep);
      }
      EXPECT_LT((reprojection.jacobian(point_in_camera) - numeric).norm(), 1e-7 * (1.0 + numeric.norm()))
          << "at depth " << depth;
    }
  }
}

TEST(Reprojection, IsMeasuredInSigmas) {
  const Rig rig = stereo_rig();
  const Eigen::Vector3d point_in_camera(0.5, -0.3, 2.0);
  const StereoPixel measured = rig.project(point_in_camera) - Eigen::Vector3d(1.0, -2.0, 0.5);
  const Reprojection reprojection(rig, measured, 0.5, 0.25);
  EXPECT_THAT(reprojection.residual(point_in_camera), PointNear(Eigen::Vector3d(2.0, -4.0, 2.0), 1e-10));
}

TEST(Reprojection, IgnoresTheDisparityOfAMonocularSighting) {
  const StereoPixel measured(300.0, 200.0, std::numeric_limits<double>::quiet_NaN());
  const Reprojection reprojection(stereo_rig(), measured, 1.0, -1.0);
  EXPECT_EQ(reprojection.residual({0.5, -0.3, 2.0}).z(), 0.0);
  EXPECT_EQ(reprojection.jacobian({0.5, -0.3, 2.0}).row(2).norm(), 0.0);
}

TEST(Reprojection, StaysFiniteAndGrowsForAPointThatMovesBehindTheCamera) {
  const Reprojection reprojection(stereo_rig(), {367.0, 252.0, 1.0}, 1.0, 0.3);
  double previous = 0.0;
  for (const double depth : {1.0, 0.1, 0.01, 1e-6, 0.0, -1e-6, -0.1, -10.0}) {
    const double error = reprojection.residual({0.1, 0.1, depth}).norm();
    EXPECT_TRUE(std::isfinite(error));
    EXPECT_GT(error, previous) << "at depth " << depth;
    previous = error;
  }
}

}  // namespace
}  // namespace byre
