#pragma once

#include "byre/geometry/calibration_sensitivity.h"
#include "byre/rig.h"

#include <functional>
#include <optional>
#include <vector>

namespace byre {

struct BundlePose {
  Pose camera_from_world;
  int rig = 0;         // index into BundleProblem::rigs
  bool fixed = false;  // an anchor
};

struct BundlePoint {
  Eigen::Vector3d position_in_world;
  bool fixed = false;  // an offline point, never moved
};

// Observation of a point in a rectified image. A negative disparity_sigma means no disparity.
struct BundleObservation {
  int pose = 0;                   // index into BundleProblem::poses
  int point = 0;                  // index into BundleProblem::points
  StereoPixel measured;           // u, v, disparity; pixels
  double pixel_sigma = 1.0;       // pixels, of u and of v
  double disparity_sigma = -1.0;  // pixels
  double weight = 1.0;            // factor on the observation's cost; reported errors and covariances exclude it

  bool is_stereo() const { return disparity_sigma > 0.0; }
};

// Self-calibration of one rig together with poses and points, as a change of its given calibration.
struct BundleCalibration {
  const CalibrationSensitivity* sensitivity = nullptr;  // belongs to the rig; owned by the caller
  int rig = 0;                                          // index into BundleProblem::rigs
  // Prior on the change, in the parameters' sigmas: mean and inverse covariance.
  CalibrationVector expected = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Identity();
};

// Measured motion between two cameras, from wheel odometry and a gyroscope.
struct BundleMotion {
  int earlier = 0;  // indices into BundleProblem::poses
  int later = 0;
  Pose later_from_earlier;
  Matrix6 information = Matrix6::Identity();  // inverse covariance of delta in exp_pose(delta) * later_from_earlier
};

// Input of the solver, by value and independent of maps.
struct BundleProblem {
  std::vector<Rig> rigs;
  std::vector<BundlePose> poses;
  std::vector<BundlePoint> points;
  std::vector<BundleObservation> observations;
  std::vector<BundleMotion> motions;             // between observed poses
  std::optional<BundleCalibration> calibration;  // empty: the calibration is fixed
};

struct BundleOptions {
  int max_iterations = 10;
  double huber_width = 2.0;     // sigmas
  int covariance_of_pose = -1;  // index of the pose whose marginal covariance is computed, or -1
  // Poses whose marginal covariances are computed together, for large problems. Precondition: observed and not fixed.
  std::vector<int> covariances_of_poses;
  double systematic_sigma = 0.0;  // pixels, for covariance_of_pose: see with_shared_errors()
  // Called before the first and after each iteration, on the calling thread; true stops the solver. The result is then
  // usable: the best poses and points so far. May be empty.
  std::function<bool()> should_stop;
};

struct BundleResult {
  std::vector<Pose> camera_from_world;           // one per pose
  std::vector<Eigen::Vector3d> points_in_world;  // one per point
  // One per observation: squared sigmas before the robust loss; infinite for a point at or behind the camera.
  std::vector<double> squared_errors;
  // Covariance of delta in exp_pose(delta) * camera_from_world for covariance_of_pose, relative to the fixed poses.
  // Empty if not requested, the pose did not move, or its observations do not determine it.
  std::optional<Matrix6> pose_covariance;
  std::vector<Matrix6> pose_covariances;  // one per covariances_of_poses; empty if not determined
  CalibrationVector calibration_change = CalibrationVector::Zero();  // change in the parameters' sigmas
  int iterations = 0;
  bool usable = false;  // false if the solver failed; poses and points are then unchanged
};

// Minimises the robust reprojection error over poses and points (Triggs 2000) with a Schur complement, see
// bundle_schur.h. Observations that start at or behind the camera are ignored; poses and points without any other
// observation do not move. Without a fixed pose or point the first observed pose is held. If the scale is undetermined
// (one camera, one held pose), the distance from the held camera to the one that starts farthest from it is held too.
BundleResult bundle_adjust(const BundleProblem& problem, const BundleOptions& options);

// The problem with its measurements corrected for a change of the calibration, which is no longer estimated.
BundleProblem with_change(BundleProblem problem, const CalibrationVector& change);

}  // namespace byre
