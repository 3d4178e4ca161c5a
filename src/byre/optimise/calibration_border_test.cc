#include "byre/optimise/calibration_border.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/optimise/bundle_scene.h"
#include "byre/optimise/reprojection.h"
#include "byre/optimise/robust_error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace byre {
namespace {

using testing::Each;
using testing::Lt;

// Calibration of an ideal stereo pair whose rectification is this rig.
Calibration calibration_of(const Rig& rig) {
  Camera camera;
  camera.width = rig.width;
  camera.height = rig.height;
  camera.fx = camera.fy = rig.focal;
  camera.cx = rig.cx;
  camera.cy = rig.cy;
  Calibration calibration;
  calibration.left = camera;
  calibration.right = StereoPartner{camera, {Eigen::Quaterniond::Identity(), {-rig.baseline, 0.0, 0.0}}};
  return calibration;
}

CalibrationVector some_change() {
  CalibrationVector change;
  for (int i = 0; i < kCalibrationParameters; ++i) change[i] = 0.4 * std::cos(1.7 * i);
  return change;
}

// A bundle measured by cameras that differ from their calibration.
class CalibratedBundle : public testing::TestWithParam<int> {  // number of moving poses
 protected:
  explicit CalibratedBundle(double noise = 0.0) {
    BundleSceneOptions options;
    options.moving_poses = GetParam();
    options.points = 150;
    options.noise = noise;
    scene_ = make_scene(5, options);
    for (BundleProblem* const problem : {&scene_.truth, &scene_.problem}) {
      problem->rigs[0] = sensitivity_.rig();
      problem->calibration = BundleCalibration{&sensitivity_, 0, some_change(), 0.01 * CalibrationMatrix::Identity()};
    }
    for (std::size_t i = 0; i < scene_.problem.observations.size(); ++i) {
      BundleObservation& seen = scene_.problem.observations[i];
      StereoPixel true_pixel = seen.measured;
      if (!seen.is_stereo()) true_pixel.z() = 0.0;
      seen.measured += sensitivity_.at(true_pixel).topRows<3>() * some_change();
    }
  }

  CalibrationSensitivity sensitivity_{calibration_of(stereo_rig())};
  BundleScene scene_;
};

TEST_P(CalibratedBundle, EstimatesTheChangeWithPosesAndPoints) {
  const BundleResult result = bundle_adjust(scene_.problem, patient());
  ASSERT_TRUE(result.usable);
  EXPECT_LT((result.calibration_change - some_change()).norm(), 1e-4);
  for (std::size_t i = 0; i < scene_.truth.poses.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(scene_.truth.poses[i].camera_from_world, 1e-5, 1e-5));
  }
  for (std::size_t i = 0; i < scene_.truth.points.size(); ++i) {
    EXPECT_THAT(result.points_in_world[i], PointNear(scene_.truth.points[i].position_in_world, 1e-4));
  }
}

INSTANTIATE_TEST_SUITE_P(DenseAndSparse, CalibratedBundle, testing::Values(6, ReducedSystem::kMaxDensePoses + 5));

class NoisyCalibratedBundle : public CalibratedBundle {
 protected:
  NoisyCalibratedBundle() : CalibratedBundle(1.0) {}

  // Robust cost at another change of the calibration than the estimated one.
  double cost(const BundleResult& result, const CalibrationVector& change, double huber_width) const {
    const CalibrationBorder border(scene_.problem, 0);
    double cost = border.cost(change);
    for (const BundleObservation& seen : scene_.problem.observations) {
      const Eigen::Vector3d point_in_camera = result.camera_from_world[static_cast<std::size_t>(seen.pose)] *
                                              result.points_in_world[static_cast<std::size_t>(seen.point)];
      const Reprojection reprojection(scene_.problem.rigs[0], seen.measured, seen.pixel_sigma, seen.disparity_sigma);
      const Eigen::Vector3d residual =
          reprojection.residual(point_in_camera) + border.jacobian(seen, point_in_camera) * change;
      cost += 0.5 * huber_cost(residual.squaredNorm(), huber_width);
    }
    return cost;
  }
};

TEST_P(NoisyCalibratedBundle, EstimatesTheChangeOfLeastCost) {
  const BundleOptions options = patient();
  const BundleResult result = bundle_adjust(scene_.problem, options);
  ASSERT_TRUE(result.usable);
  const double least = cost(result, result.calibration_change, options.huber_width);
  for (int i = 0; i < kCalibrationParameters; ++i) {
    const CalibrationVector step = 0.1 * CalibrationVector::Unit(i);
    EXPECT_GT(cost(result, result.calibration_change + step, options.huber_width), least) << "parameter " << i;
    EXPECT_GT(cost(result, result.calibration_change - step, options.huber_width), least) << "parameter " << i;
  }
}

TEST_P(NoisyCalibratedBundle, KeepsThePriorChangeOfAnUnusedRig) {
  scene_.problem.rigs.push_back(scene_.problem.rigs[0]);
  scene_.problem.calibration->rig = 1;
  const BundleResult result = bundle_adjust(scene_.problem, patient());
  ASSERT_TRUE(result.usable);
  EXPECT_LT((result.calibration_change - some_change()).norm(), 1e-3);
  scene_.problem.calibration.reset();
  const BundleResult without = bundle_adjust(scene_.problem, patient());
  for (std::size_t i = 0; i < without.camera_from_world.size(); ++i) {
    EXPECT_THAT(result.camera_from_world[i], PoseNear(without.camera_from_world[i], 1e-4, 1e-4));
  }
}

INSTANTIATE_TEST_SUITE_P(Dense, NoisyCalibratedBundle, testing::Values(6));

}  // namespace
}  // namespace byre
