#pragma once

#include "byre/rig.h"
#include "byre/workers/reused_memory.h"

#include <optional>
#include <span>

namespace byre {

// A map point and where the frame sees it.
struct PoseObservation {
  Eigen::Vector3d point_in_world;
  Eigen::Matrix3d point_covariance = Eigen::Matrix3d::Zero();  // covariance of the point in world, square metres
  StereoPixel measured;                                        // u, v, disparity; pixels
  double pixel_sigma = 1.0;                                    // pixels, of u and of v
  double disparity_sigma = -1.0;                               // pixels; negative: no disparity
  double weight = 1.0;                                         // priority: multiplies its share of the cost

  bool is_stereo() const { return disparity_sigma > 0.0; }
};

struct PoseRefinementOptions {
  int rounds = 4;  // times that inliers are chosen and then solved on robustly
  int iterations_per_round = 5;
  double huber_width = 1.5;          // sigmas
  double max_variance_factor = 9.0;  // see PoseRefinement::variance_factor
  // Pixels: what calibration, a rolling shutter and the shape of things add to an error, alike in neighbouring points
  // and neighbouring frames. It widens gates and covariance and weighs nothing, for weights are by what differs from
  // point to point. A good calibration leaves 0.1 to 0.5.
  double systematic_sigma = 0.25;
};

struct PoseRefinement {
  Pose camera_from_world;
  Matrix6 covariance = Matrix6::Zero();  // covariance of delta in exp_pose(delta) * camera_from_world
  ReusedVector<bool> inliers;            // one per observation; at or behind the camera never
  int inlier_count = 0;
  // Factor by which the residuals' variance exceeds the one stated, at least 1: where the map is not settled yet all
  // errors are larger than their sigmas. Gates, loss and covariance are widened by it.
  double variance_factor = 1.0;
  double systematic_sigma = 0.0;  // pixels, as regions of the image have it in common; see PoseRefinementOptions
};

// What is known of a pose besides what the frame sees, from wheels or a gyroscope say: the error of the pose it states.
struct PosePrior {
  Pose camera_from_world;
  Matrix6 covariance;  // covariance of delta in exp_pose(delta) * camera_from_world; positive definite
};

// Gauss-Newton on one pose against points of known uncertainty: each residual is whitened by the sum of the
// measurement's covariance and the point's, projected. Weights decide neither who is an inlier nor make the covariance
// smaller. What the inliers of a region of the image have in common, beyond noise, is taken for systematic: it adds to
// the covariance as an error of the whole region, which no number of points averages out. The gates also cut the tails
// of good measurements, which leaves the covariance's variances too small by some 5 % (stereo) to 15 % (mono). Empty
// when fewer than four observations remain or the normal equations are singular.
//
// A prior adds the squared length of log_pose(camera_from_world * inverse(prior.camera_from_world)), whitened by its
// covariance, to the squared errors of observations of weight 1. It is never an outlier, is not widened by the variance
// factor, and says nothing of which observations are inliers but by the pose.
std::optional<PoseRefinement> refine_pose(const Pose& predicted_camera_from_world, const Rig& rig,
                                          std::span<const PoseObservation> observations,
                                          const PoseRefinementOptions& options,
                                          const std::optional<PosePrior>& prior = {});

}  // namespace byre
