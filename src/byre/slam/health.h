#pragma once

#include "byre/features/image_condition.h"
#include "byre/slam/input_watch.h"

#include <cstdint>
#include <optional>
#include <string_view>

namespace byre {

// How far the pose in the map's frame may be relied on.
//   trusted    steer by it
//   degraded   likely right, but held by less than it should be: go slowly
//   untrusted  do not steer by it
enum class Verdict : std::uint8_t { trusted, degraded, untrusted };

std::string_view to_string(Verdict verdict);

// Why a pose is not trusted, or what speaks against it most.
enum class Doubt : std::uint8_t {
  none,
  no_pose,             // tracking and relocalisation fail
  blinded,             // the image is dark, overexposed, flat or blurred
  not_registered,      // tracked on an online map whose place in the offline map is not known
  unconfirmed,         // found in the map, but not over enough frames yet
  off_the_map,         // outside the mapped area for so far that drift may have become large
  few_points,          // too few points hold the pose
  few_offline_points,  // inside the mapped area, but the pose is held by online points
  clustered,           // the points lie in a small part of the image
  uncertain,           // they leave the pose open by more than is useful
  maps_disagree,       // offline and online points give different poses
  frozen,              // the camera gives the same image again
  right_camera,        // the right image is dark, overexposed, flat or blurred where the left one is not
  cameras_disagree,    // left and right images do not fit together: out of step, moved, swapped, or not calibrated so
  calibration          // points of the map fit the images by another focal length
};

std::string_view to_string(Doubt doubt);

// How far the pose from offline points alone lies from that of online points alone.
struct Agreement {
  double translation = 0.0;  // metres
  double rotation = 0.0;     // radians
};

// What one frame tells of how well the robot knows where it is. Counts are of points.
struct Health {
  Verdict verdict = Verdict::untrusted;
  Doubt doubt = Doubt::no_pose;
  int offline_expected = 0;  // in the frustum, not suspended
  int offline_matches = 0;   // of those
  int offline_inliers = 0;   // of those
  int online_inliers = 0;
  int suspended = 0;                    // offline points left out for this mission: they are not where the map has them
  double inlier_share = 0.0;            // of all matches
  double spread = 0.0;                  // of the inliers, share of the image's diagonal where they spread least
  std::optional<Agreement> agreement;   // where both kinds of points give a pose
  double position_sigma = 0.0;          // metres, the root of the trace of the covariance
  double rotation_sigma = 0.0;          // radians
  double distance_since_offline = 0.0;  // metres travelled since offline points last held the pose
  double seconds_since_offline = 0.0;
  double focal_error = 0.0;             // share by which the focal length seems too long, by the offline map
  std::optional<ImageCondition> image;  // empty for simulated frames
};

struct HealthOptions {
  double trusted_error = 0.2;        // metres: what a trusted pose promises
  double sigmas = 3.0;               // of the pose's uncertainty that must fit into that,
  double drift_share = 0.005;        // with this share of the path since offline points last held the pose
  double max_rotation_sigma = 0.02;  // radians
  int min_points = 40;               // inliers of both kinds
  double min_spread = 0.04;          // of the image's diagonal
  double max_disagreement = 0.05;    // metres between the poses from offline and from online points
  int min_offline_points = 15;       // inliers, where
  int expected_offline_points = 80;  // so many should be in view,
  double min_offline_share = 0.04;   // of those expected: fewer agree by chance where a building repeats itself
  double max_changed_path = 5.0;     // unless for less than these metres
  double max_frozen = 0.15;          // seconds that a camera may give the same image, until the pose is of no use
};

// What is known of a frame beside its measures.
struct HealthEvidence {
  bool pose_found = false;
  bool registered = true;      // the pose is in the offline map's frame
  bool confirmed = true;       // over several frames, since it was found; the calibration by a first look at it
  bool maps_disagree = false;  // beyond what the uncertainties of both explain
  ImageFault image_fault = ImageFault::none;
  InputEvidence input{};
  bool is_miscalibrated = false;  // by FocalCheck; without an offline map by a self-calibration that was refused
};

// The verdict and its reason. Uncertainty and drift together must stay within what trust promises; beyond that a pose
// is degraded while few, clustered or contradicting points hold it.
Health judged(const Health& measured, const HealthEvidence& evidence, const HealthOptions& options);

}  // namespace byre
