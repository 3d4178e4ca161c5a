#pragma once

#include "byre/playback/map_run.h"

#include <map>
#include <optional>
#include <vector>

namespace byre {

// Figures of wall times, in milliseconds. Percentiles are interpolated between their neighbours.
struct TimeSummary {
  int count = 0;
  double mean_ms = 0.0;
  double p50_ms = 0.0;
  double p95_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};

TimeSummary summarise_times(std::vector<double> seconds);  // all zero for none

// Over the frames that were processed, of one stage: summarise_stage(frames, &StageSeconds::track).
TimeSummary summarise_stage(const std::vector<MappedFrame>& frames, double StageSeconds::*stage);
// Whole frames, without mapping jobs that ran on their thread.
TimeSummary summarise_without_jobs(const std::vector<MappedFrame>& frames);

struct FrameCounts {
  int frames = 0;
  int with_pose = 0;
  int unreadable = 0;
  int without_right_image = 0;  // readable frames that came without a right image
  int with_depth_image = 0;
  int without_online_points = 0;  // frames in which few of them were looked for, or none, to keep to a deadline
  int with_left_alone = 0;        // frames whose right image was left alone for that
  int late = 0;                   // frames that took longer than their deadline all the same
  int keyframes = 0;              // frames that became keyframes
  int lost_episodes = 0;
  int lost = 0;    // frames in these episodes
  int resets = 0;  // how often a map was given up for a new one
  int relocalisations = 0;
  int loops = 0;                                 // loops found on the way
  int corrections = 0;                           // corrections of the whole map taken over on the way
  std::optional<int> frames_to_first;            // frames before the first with a pose; empty when none had one
  std::map<TwoViewFailure, int> refused_starts;  // frames with which one camera could not begin a map, by the reason

  double coverage() const { return frames > 0 ? static_cast<double>(with_pose) / frames : 0.0; }
};

FrameCounts count_frames(const std::vector<MappedFrame>& frames);

}  // namespace byre
