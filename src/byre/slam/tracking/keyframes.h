#pragma once

#include "byre/map/map_view.h"
#include "byre/slam/tracking/tracking.h"

#include <optional>
#include <span>

namespace byre {

// Fewer points or more motion require a keyframe.
struct KeyframeOptions {
  double min_tracked_share = 0.75;  // share of the points tracked in the first frame of the reference keyframe
  int min_tracked = 100;            // tracked points
  double max_turn = 0.25;           // radians of rotation from the reference keyframe
  double max_shift_share = 0.15;    // translation from the reference keyframe over the median depth
  int min_frames = 2;               // frames between keyframes, unless tracking is about to fail
};

inline constexpr int kMaxPending = 3;           // keyframes waiting for mapping
inline constexpr int kMaxPendingWhenWeak = 10;  // waiting keyframes with fewer than min_tracked points
inline constexpr int kMaxWaitForDepth = 8;      // frames that a keyframe waits for disparities
inline constexpr int kManyOffline = 75;         // offline inliers with which only motion requires a keyframe
inline constexpr int kEnoughOffline = 300;      // offline inliers from which no keyframe is needed

// Evidence for a new keyframe besides the tracked frame.
struct KeyframeEvidence {
  int fresh_inliers = 0;      // points tracked in the first frame with this reference keyframe
  int frames_since_last = 0;  // frames since the last keyframe was made
  int pending = 0;            // keyframes that are not mapped yet
  int without_depth = 0;      // frames since the last disparities, this one included; 0 for a rig without disparities
  double turn = 0.0;          // radians, rotation from the reference keyframe
  int offline_inliers = 0;    // tracked points of an offline map
  double shift_share = 0.0;   // translation from the reference keyframe over the median depth of the tracked points
};

bool needs_keyframe(const TrackedFrame& tracked, const KeyframeEvidence& evidence, const KeyframeOptions& options);

double median_depth(const TrackedFrame& tracked, const MapView& map);  // metres, zero without tracked points

// Keyframe of a tracked frame: the inliers become sightings, the reference keyframe becomes its parent.
Keyframe make_keyframe(const Frame& frame, const TrackedFrame& tracked, int rig);

// Adds a keyframe with a given pose and without points.
KeyframeId add_keyframe_at(const Pose& camera_from_world, const Frame& frame, const Rig& rig,
                           std::optional<KeyframeId> parent, MapGraph& map, int recording = 0);

// Adds a point for each feature with a precise disparity and no point yet, so that the next frame can be tracked on it.
// Skips the features in moving (ascending), which show moving objects. Returns the number of new points.
int add_stereo_points(MapGraph& map, KeyframeId id, std::span<const int> moving = {});

// A point described by its reference view; reference.keyframe must see it at the reference feature's pixel.
MapPoint make_point(const Eigen::Vector3d& position_in_world, const Eigen::Matrix3d& covariance,
                    const Observation& reference, const Features& features, const Pose& camera_from_world);

// First map from one stereo frame. Empty with fewer than min_points precise disparities.
std::optional<MapGraph> initialise_stereo(const Frame& frame, const Rig& rig, int min_points);

}  // namespace byre
