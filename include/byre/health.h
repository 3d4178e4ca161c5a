#pragma once

#include "byre/image_condition.h"

#include <cstdint>
#include <optional>
#include <string>
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
  uncertain,           // the points leave the pose open by more than is useful
  maps_disagree,       // offline and online points give different poses
  frozen,              // the camera repeats its image, bit by bit or with sensor noise
  right_camera,        // the right image is dark, overexposed, flat or blurred where the left one is not
  cameras_disagree,    // left and right images do not fit together: out of step, moved, swapped, or not calibrated so
  calibration,         // points of the map fit the images by another focal length
  bridged,             // nothing is recognised: the pose goes on by what wheels or a gyroscope tell
  dirty,               // dirt hides most of the image
  map_damaged,         // a part of the offline map's file cannot be read, see Slam::map_damage
  // There is no pose, for the robot cannot be where it was found:
  off_the_plane,  // it would stand too high, too low or too tilted on the ground that the map was driven on
  in_wall,        // it would be inside a wall of the floor plan
  outside,        // no way leads there from where the map was made
  behind_wall     // there was no time for a way around the walls, from where it was last trusted to be
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
  int offline_expected = 0;  // offline points in the frustum that are not suspended, nor behind dirt
  int offline_matches = 0;   // offline points that were matched
  int offline_inliers = 0;   // offline points that agree with the pose
  int online_inliers = 0;
  int suspended = 0;          // offline points left out for this mission: they are not where the map has them
  double inlier_share = 0.0;  // inliers as a share of all matches
  double spread = 0.0;        // how far the inliers spread where they do so least, as a share of the image's diagonal
  std::optional<Agreement> agreement;   // empty unless both kinds of points give a pose
  double position_sigma = 0.0;          // metres, the root of the trace of the covariance
  double rotation_sigma = 0.0;          // radians
  double distance_since_offline = 0.0;  // metres travelled since offline points last held the pose
  double seconds_since_offline = 0.0;
  double focal_error = 0.0;             // share by which the focal length seems too long, by the offline map
  double hidden_share = 0.0;            // share of the left image behind dirt, where no points are asked for
  double hidden_share_right = 0.0;      // share of the right image behind dirt
  std::optional<ImageCondition> image;  // empty for simulated frames
};

// What there is to be done about dirt: "dirt hides 12 % of the left image: clean the lens"; empty without dirt.
std::string note_on_dirt(const Health& health);

}  // namespace byre
