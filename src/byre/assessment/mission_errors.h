#pragma once

#include "byre/evaluation/map_frame_error.h"
#include "byre/playback/map_run.h"

#include <optional>
#include <vector>

namespace byre {

// How far the poses of a run are from the truth.
struct MissionErrors {
  // True: in the frame of the offline map, which alone was aligned to the truth. False: of a run without one, whose
  // causal and final trajectories were each aligned to the truth.
  bool in_map_frame = false;
  int alignment_poses = 0;          // poses of the run that made the map; zero: the truth is given in the map's frame
  std::vector<PoseError> causal;    // errors of poses as published
  std::vector<PoseError> trusted;   // errors of published poses reported as trusted
  std::vector<PoseError> degraded;  // errors of published poses reported as degraded
  std::vector<PoseError> final;     // errors of poses as recomputed after the last frame
  int wrongly_trusted = 0;          // frames trusted and yet off by more than kFarMetres
  double longest_wrong_trust_s = 0.0;
  std::optional<double> within_bound;             // share of causal positions within the 95 % bound of their covariance
  std::vector<PoseError> map;                     // errors of the poses that the map was aligned by
  std::optional<double> within_bound_beside_map;  // share within it when the map's own error there is taken off
};

inline constexpr double kFarMetres = 0.2;

// Errors in the frame of a map that was aligned so.
MissionErrors mission_errors(const MapRun& run, const MapAlignment& alignment, const Trajectory& truth);

// Errors after alignment, of a run without an offline map; of one camera alone with its scale.
MissionErrors aligned_errors(const MapRun& run, const Trajectory& truth, Scale scale);

}  // namespace byre
