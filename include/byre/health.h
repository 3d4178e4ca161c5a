#pragma once

#include "byre/image_condition.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace byre {

// How far the pose in the map frame may be relied on.
//   trusted    position error below 0.2 m (option health.trusted_error_m): steer by it
//   degraded   likely right, but weakly supported: go slowly
//   untrusted  do not steer by it
enum class Verdict : std::uint8_t { trusted, degraded, untrusted };

std::string_view to_string(Verdict verdict);

// Main reason against trusting a pose.
enum class DistrustReason : std::uint8_t {
  none,
  no_pose,             // tracking and relocalisation failed
  blinded,             // the image is dark, overexposed, flat or blurred
  not_registered,      // tracked on an online map that is not registered in the offline map
  unconfirmed,         // place found, but not accepted yet; without an offline map: calibration not refined yet
  off_the_map,         // so far outside the mapped area that drift may be large
  few_points,          // too few inliers
  few_offline_points,  // inside the mapped area, but supported by online points
  clustered,           // inliers cover a small part of the image
  uncertain,           // covariance too large
  maps_disagree,       // offline and online points yield different poses
  frozen,              // image repeats, bit by bit or with sensor noise only
  right_camera,        // right image dark, overexposed, flat or blurred, left one not
  cameras_disagree,    // left and right images do not match: unsynchronised, displaced, swapped, or wrong calibration
  calibration,         // map points fit the images better with another focal length
  bridged,             // no map point matched: dead reckoning by wheels or gyroscope
  dirty,               // dirt hides most of the image
  map_damaged,         // part of the offline map's file is unreadable, see Slam::map_damage
  // There is no pose, as the place found is impossible:
  off_the_plane,  // too high, too low or too tilted relative to the ground driven on while mapping
  in_wall,        // inside a wall of the floor plan
  outside,        // unreachable from the mapped area
  behind_wall     // no time to drive around the walls since the last trusted pose
};

std::string_view to_string(DistrustReason doubt);

// Remedy for an operator; empty for none.
std::string_view advice_for(DistrustReason doubt);

// Distance between the poses estimated from offline points alone and from online points alone.
struct Agreement {
  double translation = 0.0;  // metres
  double rotation = 0.0;     // radians
};

// Quality measures of one frame. Counts are of map points.
struct Health {
  Verdict verdict = Verdict::untrusted;
  DistrustReason doubt = DistrustReason::no_pose;
  int offline_expected = 0;  // offline points in the frustum, without suspended ones and those hidden by dirt
  int offline_matches = 0;   // offline points matched
  int offline_inliers = 0;   // offline points that fit the pose
  int online_inliers = 0;
  int suspended = 0;          // offline points excluded for this mission, as they have moved
  double inlier_share = 0.0;  // inliers as a share of matches
  // Standard deviation of inliers in the direction of least spread, as a share of the image diagonal.
  double spread = 0.0;
  std::optional<Agreement> agreement;   // empty unless both kinds of points yield a pose
  double position_sigma = 0.0;          // metres, root of the trace of the position covariance
  double rotation_sigma = 0.0;          // radians, root of the trace of the rotation covariance
  double distance_since_offline = 0.0;  // path length since offline points last supported the pose, metres
  double seconds_since_offline = 0.0;
  double focal_error = 0.0;   // relative excess of the focal length, estimated from offline points; 0 until estimated
  double hidden_share = 0.0;  // share of the left image hidden by dirt, where no points are searched
  double hidden_share_right = 0.0;      // share of the right image hidden by dirt
  std::optional<ImageCondition> image;  // empty for simulated frames
};

// Advice on dirt, such as "dirt hides 12 % of the left image: clean the lens"; empty without dirt.
std::string note_on_dirt(const Health& health);

}  // namespace byre
