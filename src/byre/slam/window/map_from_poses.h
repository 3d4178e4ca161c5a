#pragma once

#include "byre/slam/window/mapping.h"

#include <vector>

namespace byre {

// A frame with a given pose.
struct PosedFrame {
  Frame frame;
  Pose camera_from_world;
  int rig = 0;  // index of its rig
};

struct KnownPoseOptions {
  int neighbours = 10;         // overlapping keyframes that each one is matched with
  double pose_sigma = 1.0;     // pixels of reprojection error due to poses and calibration
  float search_radius = 8.0f;  // pixels at octave 0 around the predicted position of a point
  double assumed_depth = 4.0;  // metres, depth of cameras without disparities, only to find overlapping views
  MappingOptions mapping;
};

// Map of frames with given, fixed poses. Each frame becomes a keyframe, its parent the one before it. Points come from
// disparities and from triangulation between overlapping views, however far apart in time; duplicates are fused, points
// whose views disagree are dropped. Keyframe covariances are zero: errors of poses count as errors of measurements.
MapGraph map_from_poses(const std::vector<Rig>& rigs, const std::vector<PosedFrame>& frames,
                        const KnownPoseOptions& options);

// For each keyframe in ascending order, the keyframes with overlapping views, most overlap first.
std::vector<std::vector<KeyframeId>> overlapping_keyframes(const MapGraph& map, const KnownPoseOptions& options);

}  // namespace byre
