#pragma once

#include "byre/health.h"
#include "byre/slam/input_watch.h"

#include <optional>

namespace byre {

struct HealthOptions {
  double trusted_error = 0.2;         // metres: what a trusted pose promises
  double sigmas = 3.0;                // sigmas of the pose's position that must fit into that, together with drift
  double drift_share = 0.005;         // drift as a share of the path since offline points last held the pose
  double max_rotation_sigma = 0.02;   // radians
  double max_bridged_rotation = 0.1;  // radians, sigmas of the rotation of a pose that goes on by what is told
  int min_points = 40;                // inliers of both kinds
  double min_spread = 0.04;           // deviation of those where they spread least, as a share of the image's diagonal
  double max_disagreement = 0.05;     // metres between the poses from offline and from online points
  int min_offline_points = 15;        // offline inliers, where many should be in view
  double max_changed_path = 5.0;      // metres of path with fewer of them that are let pass
  double max_frozen = 0.15;           // seconds that a camera may give the same image, until the pose is of no use
};

// Evidence of a frame beside its measures.
struct HealthEvidence {
  bool pose_found = false;
  bool registered = true;      // the pose is in the offline map's frame
  bool confirmed = true;       // over several frames, since it was found
  bool maps_disagree = false;  // beyond what the uncertainties of both explain
  ImageFault image_fault = ImageFault::none;
  InputEvidence input{};
  bool is_miscalibrated = false;  // by FocalCheck; without an offline map by a self-calibration that is far off
  // Without an offline map: the self-calibration asked for more than a calibration errs by, or did not look yet.
  bool is_calibration_doubtful = false;
  bool is_calibration_open = false;
  // Nothing is recognised, and the pose goes on by what is told of the motion: verdict on the last one that was seen.
  std::optional<Verdict> bridged_from{};
  Doubt refused_place = Doubt::none;  // why the robot cannot be where the frame was found
  bool is_dirty = false;              // dirt hides most of the left image
};

// The doubts about images and calibration, each a LastingDoubt.
class LastingDoubts {
 public:
  // The evidence of a frame, with the causes of earlier frames whose doubts have not ended yet.
  HealthEvidence held(Timestamp time, const HealthEvidence& evidence);

 private:
  LastingDoubt repeated_;
  LastingDoubt frozen_;
  LastingDoubt right_camera_;
  LastingDoubt cameras_disagree_;
  LastingDoubt miscalibrated_;
  LastingDoubt dirty_;
  ImageFault right_fault_ = ImageFault::none;  // the last one
  bool may_be_timing_ = false;  // the images disagreed while they moved: only a pair in step ends that doubt
};

// By how much the position may be off, metres: sigmas of the pose and drift together.
double position_error(const Health& measured, const HealthOptions& options);

// Whether dirt hides so much of an image that a single moved thing may fill the rest.
bool is_mostly_hidden(double hidden_share);

// The verdict and its reason. Uncertainty and drift together must stay within what trust promises; beyond that a pose
// is degraded while few, clustered or contradicting points hold it.
Health judged(const Health& measured, const HealthEvidence& evidence, const HealthOptions& options);

}  // namespace byre
