#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

using Figure = std::optional<double>;  // empty where it does not apply, or could not be measured

// Figures of the causal poses, or of the final ones. Metres and degrees; RMSE unless the name says otherwise.
struct TrajectoryMeasures {
  Figure coverage;  // share of the frames that have a pose
  Figure ate;       // after SE(3) alignment of this very run
  Figure ate_max;
  Figure map_error;  // in the map's frame, which was aligned to the truth once, by its own keyframes
  Figure map_error_median;
  Figure map_error_max;
  Figure rpe_frame;
  Figure rpe_frame_deg;
  Figure rpe_second;
  Figure rpe_second_deg;
  Figure rpe_metre;
  Figure rpe_metre_deg;
};

// How a robot would have fared with the causal poses.
struct BehaviourMeasures {
  Figure first_pose;             // seconds from the first frame to the first pose
  Figure losses;                 // how often tracking failed
  Figure trusted_share;          // share of all frames reported as trusted
  Figure trusted_map_error_max;  // metres
  Figure trusted_wrong;          // frames reported as trusted that are off by more than kFarMetres
  Figure longest_wrong_trust;    // seconds that such frames lasted without a break
  Figure within_bound;           // share of map-frame errors within the 95 % bound of the position's covariance
  Figure keyframes;              // made during the run
  Figure keyframe_rate_known;    // a minute, while offline points held the pose
  Figure keyframe_rate_new;      // a minute, during the rest of the frames with a pose
};

struct CostMeasures {
  Figure frame_ms_mean;   // milliseconds on the frame thread, from images in memory to the report
  Figure frame_ms_p99;    // milliseconds, 99th percentile
  Figure peak_memory_mb;  // megabytes resident, of the whole program during this run
  Figure cpu_seconds;     // seconds in all threads, decoding and finishing included
};

struct RunMeasures {
  TrajectoryMeasures final_poses;
  TrajectoryMeasures causal_poses;
  BehaviourMeasures behaviour;
  CostMeasures cost;
};

// How a figure is called and printed.
template <typename Measures>
struct Measure {
  Figure Measures::*figure;
  const char* key;    // in protocols and JSON
  const char* title;  // in tables, with the unit
  double scale;       // from the figure to the unit in tables
  int digits;         // after the point in tables
  bool more_is_better;
};

std::span<const Measure<TrajectoryMeasures>> trajectory_measures();
std::span<const Measure<BehaviourMeasures>> behaviour_measures();
std::span<const Measure<CostMeasures>> cost_measures();

// One figure over the runs that have it.
struct RunSummary {
  int runs = 0;  // runs that have the figure
  double mean = 0.0;
  double median = 0.0;  // median, or the mean of the middle two of an even number
  double worst = 0.0;
};

std::optional<RunSummary> summarise_runs(const std::vector<Figure>& figures, bool more_is_better);  // empty for none

template <typename Measures>
std::optional<RunSummary> summarise_runs(const std::vector<Measures>& runs, const Measure<Measures>& measure) {
  std::vector<Figure> figures;
  for (const Measures& run : runs) figures.push_back(run.*measure.figure);
  return summarise_runs(figures, measure.more_is_better);
}

}  // namespace byre
