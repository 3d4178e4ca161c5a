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
  bool fixed = false;  // an offline point: trusted, never moved
};

// A point seen in a rectified image; without a disparity when disparity_sigma is negative.
struct BundleObservation {
  int pose = 0;                   // index into BundleProblem::poses
  int point = 0;                  // index into BundleProblem::points
  StereoPixel measured;           // u, v, disparity; pixels
  double pixel_sigma = 1.0;       // pixels, of u and of v
  double disparity_sigma = -1.0;  // pixels
  double weight = 1.0;  // factor on the observation's share of the cost; errors and covariances are told without it

  bool is_stereo() const { return disparity_sigma > 0.0; }
};

// A calibration that is to be found along with poses and points: that of one rig, as a change of the one given.
struct BundleCalibration {
  const CalibrationSensitivity* sensitivity = nullptr;  // owned by the caller, of the rig
  int rig = 0;                                          // index into BundleProblem::rigs
  // What is known beforehand, in the parameters' sigmas: where the change is expected, and how surely.
  CalibrationVector expected = CalibrationVector::Zero();
  CalibrationMatrix information = CalibrationMatrix::Identity();
};

// How one camera moved to where another one is, as wheels and a gyroscope tell it.
struct BundleMotion {
  int earlier = 0;  // indices into BundleProblem::poses
  int later = 0;
  Pose later_from_earlier;
  Matrix6 information = Matrix6::Identity();  // inverse covariance of delta in exp_pose(delta) * later_from_earlier
};

// Everything the solver needs, by value; knows nothing of maps.
struct BundleProblem {
  std::vector<Rig> rigs;
  std::vector<BundlePose> poses;
  std::vector<BundlePoint> points;
  std::vector<BundleObservation> observations;
  std::vector<BundleMotion> motions;             // between poses that are observed
  std::optional<BundleCalibration> calibration;  // empty: the calibration is taken as it is
};

struct BundleOptions {
  int max_iterations = 10;
  double huber_width = 2.0;     // sigmas
  int covariance_of_pose = -1;  // index of the pose whose marginal covariance is wanted, or -1
  // Indices of poses of which the same is wanted in a large problem, all at once. Precondition: observed, not fixed.
  std::vector<int> covariances_of_poses;
  // Asked before the first and after each iteration, on the calling thread; true ends the solution there. The result is
  // usable: the best poses and points so far. May be empty.
  std::function<bool()> should_stop;
};

struct BundleResult {
  std::vector<Pose> camera_from_world;           // one per pose
  std::vector<Eigen::Vector3d> points_in_world;  // one per point
  // One per observation: squared sigmas before the robust loss; infinite for a point at or behind the camera.
  std::vector<double> squared_errors;
  // Covariance of delta in exp_pose(delta) * camera_from_world, for the pose asked for, relative to the fixed ones.
  // Empty when none was asked for, the pose did not move, or its observations do not determine it.
  std::optional<Matrix6> pose_covariance;
  std::vector<Matrix6> pose_covariances;  // for each of those asked for; empty where they are not determined
  CalibrationVector calibration_change = CalibrationVector::Zero();  // change in the parameters' sigmas
  int iterations = 0;
  bool usable = false;  // false when the solver failed: then poses and points are as given
};

// Minimises the robust reprojection error over poses and points (Triggs 2000) with a Schur complement, see
// bundle_schur.h. Observations that start at or behind the camera have no say. Poses or points without any other stay
// where they are. With nothing fixed the first observed pose is held. Where nothing tells the scale (one camera, one
// pose held), the distance between the held camera and the one that starts farthest from it is.
BundleResult bundle_adjust(const BundleProblem& problem, const BundleOptions& options);

// The problem with the measurements that there would be, had the given calibration been so much better; its calibration
// is no longer sought.
BundleProblem with_change(BundleProblem problem, const CalibrationVector& change);

}  // namespace byre
