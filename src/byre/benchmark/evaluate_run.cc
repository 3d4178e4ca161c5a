#include "byre/benchmark/evaluate_run.h"

#include "byre/playback/report/map_statistics.h"
#include "byre/playback/report/mission_errors.h"
#include "byre/playback/report/mission_statistics.h"

#include <chrono>

namespace byre {
namespace {

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
  const TimeSummary times = summarise_stage(run.frames, &StageSeconds::total);
  if (times.count > 0) {
    measures.cost.frame_ms_mean = times.mean_ms;
    measures.cost.frame_ms_p99 = times.p99_ms;
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
