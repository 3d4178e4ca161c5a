#include "byre/benchmark/measures.h"

#include "byre/playback/report/map_statistics.h"
#include "byre/playback/report/mission_report.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <numeric>

namespace byre {
namespace {

constexpr double kMillimetres = 1e3, kPercent = 1e2, kUnchanged = 1.0;

constexpr auto kTrajectoryMeasures = std::to_array<Measure<TrajectoryMeasures>>({
    {&TrajectoryMeasures::coverage, "coverage", "coverage %", kPercent, 1, true},
    {&TrajectoryMeasures::ate, "ate_m", "ATE mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::ate_max, "ate_max_m", "ATE max mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error, "map_error_m", "map error mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error_median, "map_error_median_m", "median mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::map_error_max, "map_error_max_m", "max mm", kMillimetres, 1, false},
    {&TrajectoryMeasures::rpe_frame, "rpe_1frame_m", "RPE 1 frame mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_frame_deg, "rpe_1frame_deg", "deg", kUnchanged, 3, false},
    {&TrajectoryMeasures::rpe_second, "rpe_1s_m", "RPE 1 s mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_second_deg, "rpe_1s_deg", "deg", kUnchanged, 3, false},
    {&TrajectoryMeasures::rpe_metre, "rpe_1m_m", "RPE 1 m mm", kMillimetres, 2, false},
    {&TrajectoryMeasures::rpe_metre_deg, "rpe_1m_deg", "deg", kUnchanged, 3, false},
});

constexpr auto kBehaviourMeasures = std::to_array<Measure<BehaviourMeasures>>({
    {&BehaviourMeasures::first_pose, "first_pose_s", "first pose s", kUnchanged, 2, false},
    {&BehaviourMeasures::losses, "losses", "losses", kUnchanged, 0, false},
    {&BehaviourMeasures::trusted_share, "trusted_share", "trusted %", kPercent, 1, true},
    {&BehaviourMeasures::trusted_map_error_max, "trusted_map_error_max_m", "worst trusted mm", kMillimetres, 1, false},
    {&BehaviourMeasures::wrongly_trusted, "trusted_wrong", "trusted > 0.2 m", kUnchanged, 0, false},
    {&BehaviourMeasures::longest_wrong_trust, "longest_wrong_trust_s", "longest s", kUnchanged, 2, false},
    {&BehaviourMeasures::within_bound, "within_bound", "within 95 % bound %", kPercent, 1, true},
    {&BehaviourMeasures::keyframes, "keyframes", "keyframes", kUnchanged, 0, false},
    {&BehaviourMeasures::keyframe_rate_mapped, "keyframes_per_minute_known", "per minute, known", kUnchanged, 1, false},
    {&BehaviourMeasures::keyframe_rate_unmapped, "keyframes_per_minute_new", "per minute, new", kUnchanged, 1, false},
});

constexpr auto kCostMeasures = std::to_array<Measure<CostMeasures>>({
    {&CostMeasures::frame_ms_mean, "frame_ms_mean", "ms per frame", kUnchanged, 1, false},
    {&CostMeasures::frame_ms_p99, "frame_ms_p99", "p99 ms", kUnchanged, 1, false},
    {&CostMeasures::peak_memory_mb, "peak_memory_mb", "peak memory MB", kUnchanged, 0, false},
    {&CostMeasures::cpu_seconds, "cpu_s", "CPU s", kUnchanged, 1, false},
});

// Leaves both empty when no two poses are that far apart.
void note(const RelativePoseError& error, Figure& translation, Figure& rotation) {
  if (error.translation.count == 0) return;
  translation = error.translation.rmse;
  rotation = error.rotation.rmse;
}

TrajectoryMeasures evaluate_trajectory(const Trajectory& estimate, std::size_t frames, const RunTruth& truth) {
  TrajectoryMeasures measures;
  if (frames > 0) measures.coverage = static_cast<double>(estimate.size()) / static_cast<double>(frames);
  const std::vector<PosePair> pairs = associate(estimate, truth.poses, {});
  double scale = 1.0;
  if (const auto ate = absolute_trajectory_error(pairs, truth.scale)) {
    measures.ate = ate->translation.rmse;
    measures.ate_max = ate->translation.max;
    scale = ate->truth_from_estimate.scale;
  }
  note(relative_pose_error_by_frame(pairs, scale), measures.rpe_frame, measures.rpe_frame_deg);
  note(relative_pose_error_by_time(pairs, std::chrono::seconds(1), scale), measures.rpe_second,
       measures.rpe_second_deg);
  note(relative_pose_error_by_distance(pairs, 1.0, scale), measures.rpe_metre, measures.rpe_metre_deg);
  return measures;
}

void note_map_errors(const std::vector<PoseError>& errors, TrajectoryMeasures& measures) {
  const ErrorStatistics statistics = position_statistics(errors);
  if (statistics.count == 0) return;
  measures.map_error = statistics.rmse;
  measures.map_error_median = statistics.median;
  measures.map_error_max = statistics.max;
}

void note_trust(const MissionErrors& errors, BehaviourMeasures& measures) {
  measures.within_bound = errors.within_bound;
  if (errors.causal.empty()) return;
  measures.wrongly_trusted = errors.wrongly_trusted;
  measures.longest_wrong_trust = errors.longest_wrong_trust_s;
  if (!errors.trusted.empty()) measures.trusted_map_error_max = position_statistics(errors.trusted).max;
}

// Empty if no time was spent in such places.
Figure keyframes_per_minute(const KeyframeRate& rate) {
  if (rate.minutes <= 0.0) return std::nullopt;
  return rate.per_minute();
}

BehaviourMeasures evaluate_behaviour(const RunResult& run, bool has_map) {
  BehaviourMeasures measures;
  if (run.frames.empty()) return measures;
  const MissionStatistics mission = summarise_mission(run.frames, SessionOptions{}.mission.view.min_inliers);
  measures.first_pose = mission.seconds_to_first_pose;
  measures.losses = mission.losses;
  measures.trusted_share = static_cast<double>(mission.trusted) / static_cast<double>(run.frames.size());
  measures.keyframes = count_frames(run.frames).keyframes;
  if (has_map) measures.keyframe_rate_mapped = keyframes_per_minute(mission.in_mapped_area);
  measures.keyframe_rate_unmapped = keyframes_per_minute(mission.in_changed_or_new);
  return measures;
}

}  // namespace

std::span<const Measure<TrajectoryMeasures>> trajectory_measures() {
  return kTrajectoryMeasures;
}
std::span<const Measure<BehaviourMeasures>> behaviour_measures() {
  return kBehaviourMeasures;
}
std::span<const Measure<CostMeasures>> cost_measures() {
  return kCostMeasures;
}

std::optional<RunSummary> summarise_runs(const std::vector<Figure>& figures, bool more_is_better) {
  std::vector<double> values;
  for (const Figure& figure : figures) {
    if (figure) values.push_back(*figure);
  }
  if (values.empty()) return std::nullopt;
  std::ranges::sort(values);
  const int runs = static_cast<int>(values.size());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / runs;
  return RunSummary{runs, mean, quantile(values, 0.5), more_is_better ? values.front() : values.back()};
}

RunMeasures evaluate_run(const RunResult& run, const RunTruth& truth) {
  RunMeasures measures;
  measures.final_poses = evaluate_trajectory(run.final, run.frames.size(), truth);
  measures.causal_poses = evaluate_trajectory(run.causal, run.frames.size(), truth);
  measures.behaviour = evaluate_behaviour(run, truth.map.has_value());
  if (truth.map) {
    const MissionErrors errors = mission_errors(run, *truth.map, truth.poses);
    note_map_errors(errors.final, measures.final_poses);
    note_map_errors(errors.causal, measures.causal_poses);
    note_trust(errors, measures.behaviour);
  }
  const Distribution times = summarise_stage(run.frames, &StageSeconds::total);
  if (times.count > 0) {
    measures.cost.frame_ms_mean = times.mean;
    measures.cost.frame_ms_p99 = times.p99;
  }
  return measures;
}

std::vector<TracePoint> trace_of(const Trajectory& estimate, const RunTruth& truth) {
  const std::vector<PosePair> pairs = associate(estimate, truth.poses, {});
  Similarity truth_from_estimate;
  if (truth.map) {
    truth_from_estimate = truth.map->truth_from_map;
  } else {
    const auto aligned_run = absolute_trajectory_error(pairs, truth.scale);
    if (!aligned_run) return {};
    truth_from_estimate = aligned_run->truth_from_estimate;
  }
  std::vector<TracePoint> trace;
  for (const PosePair& pair : pairs) {
    const Eigen::Vector3d position = truth_from_estimate * pair.estimated_world_from_body.translation;
    trace.push_back({pair.time, position, (position - pair.true_world_from_body.translation).norm()});
  }
  return trace;
}

}  // namespace byre
