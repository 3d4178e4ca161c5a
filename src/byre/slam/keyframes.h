#pragma once

#include "byre/map/map_view.h"
#include "byre/slam/tracking.h"

#include <optional>
#include <span>

namespace byre {

// Fewer points, or more motion, ask for a keyframe.
struct KeyframeOptions {
  double min_tracked_share = 0.75;  // share of the points tracked when the reference keyframe became it
  int min_tracked = 100;            // points tracked
  double max_turn = 0.25;           // radians of rotation from the reference keyframe
  double max_shift_share = 0.15;    // translation from the reference keyframe over the median depth
  int min_frames = 2;               // frames between keyframes, unless tracking is about to fail
};

inline constexpr int kMaxPending = 3;           // most keyframes that wait for mapping
inline constexpr int kMaxPendingWhenWeak = 10;  // most that wait where fewer than min_tracked points are left
inline constexpr int kMaxWaitForDepth = 8;      // frames that a keyframe waits for one with disparities
inline constexpr int kEnoughOffline = 300;      // offline points tracked in a place that needs no keyframe

// What speaks for or against a new keyframe, apart from the tracked frame itself.
struct KeyframeEvidence {
  int fresh_inliers = 0;      // points tracked in the first frame with this reference keyframe
  int frames_since_last = 0;  // frames since the last keyframe was made
  int pending = 0;            // keyframes mapping has not worked on yet
  int without_depth = 0;      // frames, with this one, since one had disparities; none where the rig gives no such
  double turn = 0.0;          // radians, rotation from the reference keyframe
  int offline_inliers = 0;    // tracked points of an offline map
  double shift_share = 0.0;   // translation from the reference keyframe over the median depth of the tracked points
};

bool needs_keyframe(const TrackedFrame& tracked, const KeyframeEvidence& evidence, const KeyframeOptions& options);

double median_depth(const TrackedFrame& tracked, const MapView& map);  // metres, zero when nothing is tracked

// The keyframe a tracked frame becomes: its inliers are its sightings, and the keyframe it was tracked from its parent.
Keyframe make_keyframe(const Frame& frame, const TrackedFrame& tracked, int rig);

// Adds a point for every feature of the keyframe that has a trustworthy disparity and sees no point yet, so that the
// very next frame can be tracked on them; but for the features (ascending) of things that seem to move. Returns how
// many.
int add_stereo_points(Map& map, KeyframeId id, std::span<const int> moving = {});

// A point as its reference view describes it; reference.keyframe must see it at the reference feature's pixel.
MapPoint make_point(const Eigen::Vector3d& position_in_world, const Eigen::Matrix3d& covariance,
                    const Observation& reference, const Features& features, const Pose& camera_from_world);

// A first map from one stereo frame. Empty when it has fewer than min_points trustworthy disparities.
std::optional<Map> initialise_stereo(const Frame& frame, const Rig& rig, int min_points);

}  // namespace byre
