#pragma once

#include "byre/playback/map_run.h"
#include "byre/trajectory_error.h"

#include <optional>
#include <utility>
#include <vector>

namespace byre {

// Keyframes made in so much time of the recording.
struct KeyframeRate {
  int keyframes = 0;
  double minutes = 0.0;

  double per_minute() const { return minutes > 0.0 ? keyframes / minutes : 0.0; }
};

// What a mission on a map came to.
struct MissionStatistics {
  int frames = 0;
  int missing = 0;  // frames that could not be read: none of what follows is known of them
  int trusted = 0;
  int degraded = 0;
  int untrusted = 0;
  std::vector<std::pair<Doubt, int>> doubts;  // in frames that are not trusted, the most frequent first
  std::optional<double> seconds_to_first_pose;
  int losses = 0;
  int relocalisations = 0;
  int navigation_errors = 0;
  KeyframeRate in_known_places;     // offline points held the pose
  KeyframeRate in_changed_or_new;   // the rest of the frames with a pose
  ErrorStatistics offline_inliers;  // offline inliers of frames with a pose
  ErrorStatistics online_inliers;   // online inliers of frames with a pose
  int most_suspended = 0;           // most offline points suspended at a time
  double most_hidden = 0.0;         // most of a left image that dirt hid, as a share
  double most_hidden_right = 0.0;   // most of a right image that it hid, as a share
  int frames_with_dirt = 0;         // frames with any of either image hidden
};

// Whether so many frames are missing that the others do not represent the recording.
bool is_full_of_gaps(int missing, int frames);
inline bool is_full_of_gaps(const MissionStatistics& statistics) {
  return is_full_of_gaps(statistics.missing, statistics.frames);
}

// A place is known where a frame has at least so many offline inliers.
MissionStatistics summarise_mission(const std::vector<MappedFrame>& frames, int min_offline_inliers);

}  // namespace byre
