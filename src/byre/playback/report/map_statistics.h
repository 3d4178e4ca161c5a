#pragma once

#include "byre/geometry/evaluation/distribution.h"
#include "byre/playback/play.h"

#include <map>
#include <optional>
#include <vector>

namespace byre {

// Statistics of wall times, milliseconds.
Distribution summarise_times(std::vector<double> seconds);  // all zero for an empty vector

// Times of one stage over the processed frames: summarise_stage(frames, &StageSeconds::track).
Distribution summarise_stage(const std::vector<PlayedFrame>& frames, double StageSeconds::*stage);
// Times of whole frames, without mapping jobs on the frame thread.
Distribution summarise_without_jobs(const std::vector<PlayedFrame>& frames);

struct FrameCounts {
  int frames = 0;
  int with_pose = 0;
  int unreadable = 0;
  int without_right_image = 0;
  int with_depth_image = 0;
  int without_online_points = 0;  // frames that searched few or no online points to meet their deadline
  int with_left_alone = 0;        // frames that skipped their right image to meet their deadline
  int late = 0;                   // frames that missed their deadline
  int keyframes = 0;              // frames that became keyframes
  int lost_episodes = 0;
  int lost = 0;    // frames in lost episodes
  int resets = 0;  // maps abandoned for a new one
  int relocalisations = 0;
  int loops = 0;
  int corrections = 0;                           // corrections of the whole map applied during the run
  std::optional<int> frames_to_first;            // frames before the first pose; empty without a pose
  std::map<TwoViewFailure, int> refused_starts;  // frames with which monocular initialisation failed, by reason

  double coverage() const { return frames > 0 ? static_cast<double>(with_pose) / frames : 0.0; }
};

FrameCounts count_frames(const std::vector<PlayedFrame>& frames);

}  // namespace byre
