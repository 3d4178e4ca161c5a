#pragma once

#include "byre/slam/mapping.h"

#include <vector>

namespace byre {

// A frame and where it was taken, as somebody else found out.
struct PosedFrame {
  Frame frame;
  Pose camera_from_world;
  int rig = 0;  // index of the rig that took it, among those given beside
};

struct KnownPoseOptions {
  int neighbours = 10;         // keyframes with overlapping views that each is matched with
  double pose_sigma = 1.0;     // pixels by which errors of poses and calibration move a point in the image
  float search_radius = 8.0f;  // pixels at octave 0 about the place where a point should appear
  double assumed_depth = 4.0;  // metres, of what a camera without disparities sees; only to tell whose views overlap
  MappingOptions mapping;
};

// The map of frames whose poses are given and held as they are: each becomes a keyframe, its parent the one before it.
// Points come from disparities and from triangulation between views that overlap, however far apart in time; those
// seen twice are fused, those whose views disagree are left out. Keyframes' covariances are zero: the poses are taken
// for exact, their errors for those of measurements.
Map map_from_poses(const std::vector<Rig>& rigs, const std::vector<PosedFrame>& frames,
                   const KnownPoseOptions& options);

// Keyframes of a map whose views overlap, for each in ascending order those that overlap with it, most overlap first.
std::vector<std::vector<KeyframeId>> overlapping_keyframes(const Map& map, const KnownPoseOptions& options);

}  // namespace byre
