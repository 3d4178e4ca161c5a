#pragma once

#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/playback/play.h"

#include <optional>
#include <span>
#include <vector>

namespace byre {

using Figure = std::optional<double>;  // empty if not applicable or not measurable

// Figures of causal or of final poses. Metres and degrees; RMSE unless the name differs.
struct TrajectoryMeasures {
  Figure coverage;  // share of frames with a pose
  Figure ate;       // after SE(3) alignment of this run
  Figure ate_max;
  Figure map_error;  // in the map's frame; the map was aligned to the truth once, by its own keyframes
  Figure map_error_median;
  Figure map_error_max;
  Figure rpe_frame;
  Figure rpe_frame_deg;
  Figure rpe_second;
  Figure rpe_second_deg;
  Figure rpe_metre;
  Figure rpe_metre_deg;
};

struct BehaviourMeasures {
  Figure first_pose;              // seconds from the first frame to the first pose
  Figure losses;                  // number of tracking losses
  Figure trusted_share;           // share of all frames with verdict trusted
  Figure trusted_map_error_max;   // metres
  Figure wrongly_trusted;         // trusted frames with an error above kFarMetres
  Figure longest_wrong_trust;     // longest uninterrupted span of such frames, seconds
  Figure within_bound;            // share of map-frame errors within the 95 % bound of the position covariance
  Figure keyframes;               // added during the run
  Figure keyframe_rate_mapped;    // per minute, in frames whose pose rests on offline points
  Figure keyframe_rate_unmapped;  // per minute, in the other frames with a pose
};

struct CostMeasures {
  Figure frame_ms_mean;   // milliseconds on the frame thread, from images in memory to the report
  Figure frame_ms_p99;    // milliseconds, 99th percentile
  Figure peak_memory_mb;  // peak resident memory of the program during this run
  Figure cpu_seconds;     // in all threads, including decoding and finishing
};

struct RunMeasures {
  TrajectoryMeasures final_poses;
  TrajectoryMeasures causal_poses;
  BehaviourMeasures behaviour;
  CostMeasures cost;
};

// Names and format of a figure.
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

struct RunSummary {
  int runs = 0;
  double mean = 0.0;
  double median = 0.0;  // mean of the middle two for an even number
  double worst = 0.0;
};

std::optional<RunSummary> summarise_runs(const std::vector<Figure>& figures, bool more_is_better);

template <typename Measures>
std::optional<RunSummary> summarise_runs(const std::vector<Measures>& runs, const Measure<Measures>& measure) {
  std::vector<Figure> figures;
  for (const Measures& run : runs) figures.push_back(run.*measure.figure);
  return summarise_runs(figures, measure.more_is_better);
}

struct RunTruth {
  const Trajectory& poses;          // true poses at the recording's times
  std::optional<MapAlignment> map;  // alignment of the run's offline map; empty without one
  Scale scale = Scale::fixed;       // free for a monocular run without a map
};

// All measures except memory and CPU time, which a RunResult does not contain.
RunMeasures evaluate_run(const RunResult& run, const RunTruth& truth);

struct TracePoint {
  Timestamp time{};
  Eigen::Vector3d position_in_truth;
  double error = 0.0;  // metres
};

// In the map's frame with a map, else after alignment. Empty if there is no alignment.
std::vector<TracePoint> trace_of(const Trajectory& estimate, const RunTruth& truth);

}  // namespace byre
