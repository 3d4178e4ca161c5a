#pragma once

#include "byre/playback/play.h"
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

}  // namespace byre
