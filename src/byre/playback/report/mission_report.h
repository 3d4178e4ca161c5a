#pragma once

#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/playback/play.h"
#include "byre/playback/report/report.h"
#include "byre/playback/scaled_recording.h"
#include "byre/trajectory_error.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

struct KeyframeRate {
  int keyframes = 0;
  double minutes = 0.0;

  double per_minute() const { return minutes > 0.0 ? keyframes / minutes : 0.0; }
};

struct MissionStatistics {
  int frames = 0;
  int missing = 0;  // unreadable frames, not counted below
  int trusted = 0;
  int degraded = 0;
  int untrusted = 0;
  std::vector<std::pair<DistrustReason, int>> doubts;  // doubts of frames that are not trusted, most frequent first
  std::optional<double> seconds_to_first_pose;
  int losses = 0;
  int relocalisations = 0;
  int navigation_errors = 0;
  KeyframeRate in_mapped_area;      // frames whose pose rests on offline points
  KeyframeRate in_changed_or_new;   // all other frames with a pose
  ErrorStatistics offline_inliers;  // per frame with a pose
  ErrorStatistics online_inliers;   // per frame with a pose
  int max_suspended = 0;            // maximum number of offline points suspended at once
  double max_hidden = 0.0;          // maximum share of a left image hidden by dirt
  double max_hidden_right = 0.0;    // maximum share of a right image hidden by dirt
  int frames_with_dirt = 0;         // frames with dirt in either image
};

// Whether too many frames are missing for the rest to represent the recording.
bool misses_too_many_frames(int missing, int frames);
inline bool misses_too_many_frames(const MissionStatistics& statistics) {
  return misses_too_many_frames(statistics.missing, statistics.frames);
}

// min_offline_inliers: offline inliers from which a frame counts as in_mapped_area.
MissionStatistics summarise_mission(const std::vector<PlayedFrame>& frames, int min_offline_inliers);

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

struct MissionOutcome {
  MissionStatistics statistics;
  std::optional<MissionErrors> errors;  // only with truth
};

Report mission_report(const MissionStatistics& statistics);
Report mission_error_report(const MissionErrors& errors);

// Truth that a mission is evaluated against.
struct MissionTruth {
  Trajectory frames;
  Trajectory map;  // true poses at the times of the map's recording
  // Estimated poses of the mapping run, which align the map to the truth; empty: its keyframes.
  std::optional<Trajectory> map_run;
  Scale map_scale = Scale::fixed;  // whether the alignment of the map estimates scale
};

// Statistics and errors of a run: in the frame of its offline map, or without one after alignment. Errors need truth.
MissionOutcome evaluate_mission(const RunResult& run, const MethodOptions& options,
                                const std::optional<MissionTruth>& truth, const ScaledRecording& recording);

}  // namespace byre
