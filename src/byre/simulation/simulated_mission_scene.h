#pragma once

#include "byre/features.h"
#include "byre/map/map_graph.h"
#include "byre/rig.h"
#include "byre/simulation/simulated_trajectory_scene.h"

#include <cstdint>

namespace byre {

// A box-shaped room with landmarks on walls, floor and ceiling; the world's origin is its centre. A landmark has a
// size: its octave grows as the camera approaches, and it is visible over kOctaves octaves only.
struct SimulationOptions {
  int landmarks = 2000;
  Eigen::Vector3d room_size{10.0, 8.0, 4.0};  // metres
  double pixel_sigma = 0.5;                   // pixels at octave 0, scaled with the octave
  double disparity_sigma = 0.3;               // pixels at octave 0, scaled with the octave
  double min_disparity = 1.0;                 // pixels; farther landmarks have no disparity
  double outlier_ratio = 0.0;                 // share of features moved to a random pixel and disparity
  double missing_ratio = 0.1;                 // share of visible landmarks that are missed
  double descriptor_flip_ratio = 0.03;        // share of flipped descriptor bits
  int max_features = 1000;
  std::uint64_t seed = 1;        // draws the landmarks; equal for visits to the same room
  std::uint64_t noise_seed = 1;  // draws all that differs between visits
};

struct SimulatedMission {
  Rig rig;
  Trajectory truth;  // world_from_body
  std::vector<Frame> frames;
  std::vector<std::vector<int>> landmark_of_feature;  // per frame and feature: true landmark, or -1 for an outlier
  std::vector<Eigen::Vector3d> landmarks_in_world;
};

// Simulates frames without images, for tests of everything above features/. Deterministic. Without a baseline no
// feature has a disparity.
SimulatedMission simulate_mission(const Rig& rig, const Trajectory& truth, const SimulationOptions& options);

// The map of an ideal mapping run with every n-th frame a keyframe: true poses, and at their true positions all
// landmarks seen by two keyframes or by one with disparity.
MapGraph true_map(const SimulatedMission& mission, int frames_per_keyframe, Origin origin);

}  // namespace byre
