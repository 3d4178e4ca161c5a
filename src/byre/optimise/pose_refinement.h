#pragma once

#include "byre/base/scratch_memory.h"
#include "byre/rig.h"

#include <optional>
#include <span>

namespace byre {

// A map point and its measurement in the frame.
struct PoseObservation {
  Eigen::Vector3d point_in_world;
  Eigen::Matrix3d point_covariance = Eigen::Matrix3d::Zero();  // in the world, square metres
  StereoPixel measured;                                        // u, v, disparity; pixels
  double pixel_sigma = 1.0;                                    // pixels, of u and of v
  double disparity_sigma = -1.0;                               // pixels; negative: no disparity
  double weight = 1.0;                                         // priority: factor on its cost

  bool is_stereo() const { return disparity_sigma > 0.0; }
};

struct PoseRefinementOptions {
  int rounds = 4;  // times that inliers are selected and the pose is optimised robustly on them
  int iterations_per_round = 5;
  double huber_width = 1.5;          // sigmas
  double max_variance_factor = 9.0;  // see PoseRefinement::variance_factor
  // Pixels: errors by calibration, rolling shutter and shape that neighbouring points and frames share. Widens gates
  // and covariance, but does not change weights, which differ from point to point. A good calibration leaves 0.1 to
  // 0.5.
  double systematic_sigma = 0.25;
};

struct PoseRefinement {
  Pose camera_from_world;
  Matrix6 covariance = Matrix6::Zero();  // covariance of delta in exp_pose(delta) * camera_from_world
  ScratchVector<bool> inliers;           // one per observation; false at or behind the camera
  int inlier_count = 0;
  // Factor by which the residuals' variance exceeds the stated one, at least 1: in an unsettled map all errors are
  // larger than their sigmas. Widens gates, loss and covariance.
  double variance_factor = 1.0;
  double systematic_sigma = 0.0;  // estimated, pixels; see PoseRefinementOptions
};

// Prior on the pose, for example from wheels or a gyroscope.
struct PosePrior {
  Pose camera_from_world;
  Matrix6 covariance;  // covariance of delta in exp_pose(delta) * camera_from_world; positive definite
};

// Gauss-Newton on one pose from points with given covariances: each residual is whitened by the covariance of its
// measurement plus that of its point, projected. Weights neither select inliers nor reduce the covariance. Errors that
// the inliers of an image region share beyond noise are systematic: they add to the covariance as an error of the whole
// region, which does not average out over points. Gates cut the tails of good measurements, so that variances are about
// 5 % (stereo) to 15 % (mono) too small. Empty with fewer than four inliers or singular normal equations.
//
// A prior adds the squared length of log_pose(camera_from_world * inverse(prior.camera_from_world)), whitened by its
// covariance, at the scale of observations of weight 1. It is never an outlier, is not widened by the variance factor,
// and affects the selection of inliers only through the pose.
std::optional<PoseRefinement> refine_pose(const Pose& predicted_camera_from_world, const Rig& rig,
                                          std::span<const PoseObservation> observations,
                                          const PoseRefinementOptions& options,
                                          const std::optional<PosePrior>& prior = {});

}  // namespace byre
