#pragma once

#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/playback/play.h"

#include <optional>
#include <vector>

namespace byre {

struct MissionErrors {
  // True: errors in the frame of the offline map, the only thing aligned to the truth. False: a run without offline
  // map; causal and final trajectories are each aligned to the truth.
  bool in_map_frame = false;
  int alignment_poses = 0;        // poses of the mapping run that align the map; 0: the truth is in the map's frame
  std::vector<PoseError> causal;  // published poses
  std::vector<PoseError> trusted;
  std::vector<PoseError> degraded;
  std::vector<PoseError> final;  // poses recomputed after the last frame
  int wrongly_trusted = 0;       // trusted frames with an error above kFarMetres
  double longest_wrong_trust_s = 0.0;
  std::optional<double> within_bound;  // share of causal positions within the 95 % bound of their covariance
  std::vector<PoseError> map;          // poses that align the map
  std::optional<double> within_bound_without_map_error;  // within_bound after subtraction of the map's local error
};

inline constexpr double kFarMetres = 0.2;

MissionErrors mission_errors(const RunResult& run, const MapAlignment& alignment, const Trajectory& truth);

// Errors after alignment, for a run without an offline map. scale: free for a monocular map.
MissionErrors aligned_errors(const RunResult& run, const Trajectory& truth, Scale scale);

}  // namespace byre
