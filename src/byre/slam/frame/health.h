#pragma once

#include "byre/health.h"
#include "byre/slam/frame/image_monitor.h"

#include <optional>

namespace byre {

struct HealthOptions {
  double trusted_error = 0.2;         // metres, error bound of a trusted pose
  double sigmas = 3.0;                // sigmas of the position that must be within trusted_error, together with drift
  double drift_share = 0.005;         // drift per length of path since offline points last constrained the pose
  double max_rotation_sigma = 0.02;   // radians
  double max_bridged_rotation = 0.1;  // radians, `sigmas` times the rotation sigma of a dead-reckoned pose
  int min_points = 30;                // inliers of both maps
  // Standard deviation of the inliers in their narrowest direction, share of the image diagonal.
  double min_spread = 0.04;
  double max_disagreement = 0.05;  // metres between the poses from offline and from online points
  int min_offline_points = 10;     // offline inliers, if many are expected in view
  double max_changed_path = 5.0;   // metres of path with fewer offline inliers until the pose is degraded
  double max_frozen = 0.15;        // seconds of a repeated image until the pose is untrusted
};

// Evidence of a frame besides its measures.
struct HealthEvidence {
  bool pose_found = false;
  bool registered = true;      // the pose is in the offline map's frame
  bool confirmed = true;       // the place is confirmed and accepted
  bool maps_disagree = false;  // beyond the uncertainty of both poses
  ImageFault image_fault = ImageFault::none;
  InputEvidence input{};
  bool is_miscalibrated = false;  // by FocalCheck; without an offline map by an implausible self-calibration
  // Without an offline map: the self-calibration was refused as implausible, or has not run yet.
  bool is_calibration_doubtful = false;
  bool is_calibration_open = false;
  // Verdict of the last visual pose; set for a dead-reckoned pose.
  std::optional<Verdict> bridged_from{};
  DistrustReason refused_place = DistrustReason::none;  // why a place that shows the frame was rejected
  bool is_dirty = false;                                // dirt hides most of the left image
};

// The doubts about images and calibration, each a FaultLatch.
class FaultLatches {
 public:
  // Adds causes of earlier frames whose doubts have not ended yet to the evidence of a frame.
  HealthEvidence latch(Timestamp time, const HealthEvidence& evidence);

 private:
  FaultLatch repeated_;
  FaultLatch frozen_;
  FaultLatch right_camera_;
  FaultLatch cameras_disagree_;
  FaultLatch miscalibrated_;
  FaultLatch dirty_;
  ImageFault right_fault_ = ImageFault::none;  // last fault of the right image
  bool may_be_timing_ = false;                 // the images disagreed in motion: only a pair in step ends that doubt
};

// Bound on the position error, metres: sigmas of the pose, and the drift, which is independent of them.
double position_error(const Health& measured, const HealthOptions& options);

// Whether dirt hides so much of an image that one moved object may fill the rest.
bool is_mostly_hidden(double hidden_share);

// Sets verdict and doubt. Untrusted if position_error() exceeds the error bound of a trusted pose. Degraded while
// few, clustered or contradicting points constrain the pose.
Health assess(const Health& measured, const HealthEvidence& evidence, const HealthOptions& options);

}  // namespace byre
