#pragma once

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/reprojection.h"
#include "byre/pose.h"

#include <ceres/sized_cost_function.h>

namespace byre {

// Costs between camera_from_world, which Ceres gets as two blocks (rotation as quaternion x, y, z, w; translation),
// and point_in_world. All residuals have three rows and all blocks three degrees of freedom, because for these sizes
// Ceres has a Schur complement compiled for the purpose; a monocular row of zeros costs less than a general one.
// Rotations move on the RotationManifold.

// Both the pose and the point move. Parameters: rotation, translation, point.
class PoseAndPointCost final : public ceres::SizedCostFunction<3, 4, 3, 3> {
 public:
  explicit PoseAndPointCost(const Reprojection& reprojection) : reprojection_(reprojection) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;  // constant after construction
};

// The change of a calibration, as Ceres gets it: blocks of three, see above.
inline constexpr int kCalibrationBlocks = kCalibrationParameters / 3;
static_assert(kCalibrationBlocks == 7 && kCalibrationParameters == 3 * kCalibrationBlocks);

// Pose, point and the calibration of the cameras move. Parameters: rotation, translation, point, change of calibration.
// The calibration acts where the point is expected, not where it was measured: there the slope would share the noise of
// the residual, and hundreds of thousands of measurements would agree on a focal length that is too long.
class CalibrationCost final : public ceres::SizedCostFunction<3, 4, 3, 3, 3, 3, 3, 3, 3, 3, 3> {
 public:
  // Rig and sensitivity are owned by the caller.
  CalibrationCost(const Rig& rig, const CalibrationSensitivity& sensitivity, const BundleObservation& observation);
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Eigen::Matrix<double, 3, kCalibrationParameters> by_calibration(const Eigen::Vector3d& point_in_camera) const;

  PoseAndPointCost cost_;  // cost by the given calibration; constant after construction
  const Rig& rig_;
  const CalibrationSensitivity& sensitivity_;
  StereoPixel measured_;       // constant after construction
  Eigen::Vector3d per_pixel_;  // residuals by pixels, constant after construction
};

// What is known of the calibration beforehand. Parameter: change of calibration.
class CalibrationPriorCost final : public ceres::SizedCostFunction<kCalibrationParameters, 3, 3, 3, 3, 3, 3, 3> {
 public:
  CalibrationPriorCost(const CalibrationVector& expected, const CalibrationMatrix& information);
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  CalibrationVector expected_;     // constant after construction
  CalibrationMatrix square_root_;  // upper, of the information; constant after construction
};

// The pose moves, the point is trusted. Parameters: rotation, translation.
class PoseCost final : public ceres::SizedCostFunction<3, 4, 3> {
 public:
  PoseCost(const Reprojection& reprojection, const Eigen::Vector3d& point_in_world)
      : reprojection_(reprojection), point_in_world_(point_in_world) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;       // constant after construction
  Eigen::Vector3d point_in_world_;  // constant after construction
};

// The camera stays at a distance from a place, sigma metres more or less. Parameters: rotation, translation.
class DistanceCost final : public ceres::SizedCostFunction<1, 4, 3> {
 public:
  DistanceCost(const Eigen::Vector3d& place_in_world, double distance, double sigma)
      : place_in_world_(place_in_world), distance_(distance), sigma_(sigma) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Eigen::Vector3d place_in_world_;  // constant after construction
  double distance_;                 // metres, constant after construction
  double sigma_;                    // metres, constant after construction
};

// The point moves, the pose is an anchor. Parameter: point.
class PointCost final : public ceres::SizedCostFunction<3, 3> {
 public:
  PointCost(const Reprojection& reprojection, const Pose& camera_from_world)
      : reprojection_(reprojection), camera_from_world_(camera_from_world) {}
  bool Evaluate(const double* const* parameters, double* residual, double** jacobians) const override;

 private:
  Reprojection reprojection_;  // constant after construction
  Pose camera_from_world_;     // constant after construction
};

}  // namespace byre
