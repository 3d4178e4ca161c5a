#pragma once

#include "byre/place/place_index.h"
#include "byre/slam/places/localisation.h"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// A stored frame: a keyframe's features, at the pixels measured by its sightings.
struct ReplayFrame {
  Frame frame;
  Rig rig;
  Pose camera_from_world;                // pose in its mission
  Matrix6 covariance = Matrix6::Zero();  // covariance of that pose, see Keyframe::covariance
};

std::vector<ReplayFrame> frames_to_replay(const MapGraph& map);

struct Replayed {
  std::optional<Pose> camera_from_world;  // empty: not found
  Matrix6 covariance = Matrix6::Zero();   // see TrackedFrame::match_covariance
  int inliers = 0;
};

// Localises each frame in a map without a prediction.
std::vector<Replayed> replay(std::span<const ReplayFrame> frames, const MapGraph& map, const PlaceIndex& index);

// Whether a frame is found away from the pose in its mission; false if it is not found.
bool is_elsewhere(const ReplayFrame& frame, const Replayed& found);

// Frames of one place, a 4 m cube and one of six main directions, on a map and on its update.
struct PlaceProof {
  Eigen::Vector3d centre_in_map = Eigen::Vector3d::Zero();  // mean position of the cameras
  int frames = 0;
  int found_before = 0, found_after = 0;
  int inliers_before = 0, inliers_after = 0;  // frames found in both maps only
  // Mean change of their poses, and the standard deviation of a pose before: errors of a place's points are common to
  // its frames.
  double shift = 0.0, shift_sigma = 0.0;  // metres
  double turn = 0.0, turn_sigma = 0.0;    // radians
  std::string fault{};                    // why the place is worse; empty: it is not
};

// Compares the places of frames; those found elsewhere count as not found. before, after: results of replay.
// least_inliers: share of the inliers before.
std::vector<PlaceProof> compare_places(std::span<const ReplayFrame> frames, std::span<const Replayed> before,
                                       std::span<const Replayed> after, double least_inliers = 0.9);

}  // namespace byre
