#pragma once

#include "byre/features.h"
#include "byre/map/map.h"
#include "byre/rig.h"
#include "byre/simulation/simulated_trajectory.h"

#include <cstdint>

namespace byre {

// A box of a room whose walls, floor and ceiling carry landmarks; the room's centre is the origin of the world.
// A landmark has a size, so that its octave grows as the camera comes near, and it is seen over kOctaves octaves only.
struct SimulationOptions {
  int landmarks = 2000;
  Eigen::Vector3d room_size{10.0, 8.0, 4.0};  // metres
  double pixel_sigma = 0.5;                   // pixels at octave 0, times the octave's scale
  double disparity_sigma = 0.3;               // pixels at octave 0, times the octave's scale
  double min_disparity = 1.0;                 // pixels: landmarks farther than this have no disparity
  double outlier_ratio = 0.0;                 // share of features that are put at a random pixel and disparity
  double missing_ratio = 0.1;                 // share of visible landmarks that are not detected
  double descriptor_flip_ratio = 0.03;        // share of descriptor bits that are flipped
  int max_features = 1000;
  std::uint64_t seed = 1;        // draws the landmarks: equal seeds are visits to the same room
  std::uint64_t noise_seed = 1;  // draws everything that differs from visit to visit
};

struct SimulatedMission {
  Rig rig;
  Trajectory truth;  // world_from_body
  std::vector<Frame> frames;
  std::vector<std::vector<int>> landmark_of_feature;  // per frame, per feature: true landmark; -1: outlier
  std::vector<Eigen::Vector3d> landmarks_in_world;
};

// Frames without images: everything above features/ can be tested on these. The same options give the same frames.
// Without a baseline no feature has a disparity.
SimulatedMission simulate_mission(const Rig& rig, const Trajectory& truth, const SimulationOptions& options);

// The map a perfect mapping run would make, with every n-th frame a keyframe: true poses, and at their true places the
// landmarks that two keyframes see or one with a disparity.
Map true_map(const SimulatedMission& mission, int frames_per_keyframe, Origin origin);

}  // namespace byre
