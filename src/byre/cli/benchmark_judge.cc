#include "byre/cli/benchmark_judge.h"

#include "byre/cli/map_statistics.h"

#include <algorithm>
#include <chrono>
#include <map>

#include <Eigen/Cholesky>

namespace byre::cli {
namespace {

constexpr double kMetricScale = 1.0;

// Either is empty when no two poses are that far apart.
void note(const RelativePoseError& error, Figure& translation, Figure& rotation) {
  if (error.translation.count == 0) return;
  translation = error.translation.rmse;
  rotation = error.rotation.rmse;
}

void note_map_errors(const Trajectory& estimate, const RunTruth& truth, TrajectoryMeasures& measures) {
  if (!truth.map) return;
  const ErrorStatistics errors = position_statistics(errors_in_map(estimate, truth.poses, *truth.map));
  if (errors.count == 0) return;
  measures.map_error = errors.rmse;
  measures.map_error_median = errors.median;
  measures.map_error_max = errors.max;
}

TrajectoryMeasures judge_trajectory(const Trajectory& estimate, std::size_t frames, const RunTruth& truth) {
  TrajectoryMeasures measures;
  if (frames > 0) measures.coverage = static_cast<double>(estimate.size()) / static_cast<double>(frames);
  const std::vector<PosePair> pairs = associate(estimate, truth.poses, {});
  if (const auto ate = absolute_trajectory_error(pairs, Scale::fixed)) {
    measures.ate = ate->translation.rmse;
    measures.ate_max = ate->translation.max;
  }
  note_map_errors(estimate, truth, measures);
  note(relative_pose_error_by_frame(pairs, kMetricScale), measures.rpe_frame, measures.rpe_frame_deg);
  note(relative_pose_error_by_time(pairs, std::chrono::seconds(1), kMetricScale), measures.rpe_second,
       measures.rpe_second_deg);
  note(relative_pose_error_by_distance(pairs, 1.0, kMetricScale), measures.rpe_metre, measures.rpe_metre_deg);
  return measures;
}

// Of the position alone: some recordings' true rotation is worse than what is to be judged.
bool is_within_bound(const PoseError& error, const Matrix6& covariance) {
  constexpr double kChiSquared95 = 7.815;  // of three degrees of freedom
  const Eigen::LLT<Eigen::Matrix3d> factors(covariance.topLeftCorner<3, 3>());
  if (factors.info() != Eigen::Success) return false;
  return factors.matrixL().solve(error.delta.head<3>()).squaredNorm() <= kChiSquared95;
}

double share(int part, int whole) {
  return static_cast<double>(part) / whole;
}

// Compares what the reports claim with the errors in the map's frame.
void note_trust(const std::map<Timestamp, const FrameReport*>& reports, const std::vector<PoseError>& errors,
                BehaviourMeasures& measures) {
  if (errors.empty()) return;
  int within = 0, wrong = 0;
  for (const PoseError& error : errors) {
    const FrameReport& report = *reports.at(error.time);
    within += is_within_bound(error, report.covariance) ? 1 : 0;
    if (report.health.verdict != Verdict::trusted) continue;
    wrong += error.position() > kWrongMetres ? 1 : 0;
    measures.trusted_map_error_max = std::max(measures.trusted_map_error_max.value_or(0.0), error.position());
  }
  measures.within_bound = share(within, static_cast<int>(errors.size()));
  measures.trusted_wrong = wrong;
}

Figure seconds_to_first_pose(const MapRun& run) {
  if (run.causal.empty()) return std::nullopt;
  return to_seconds(run.causal.front().time - run.frames.front().time);
}

BehaviourMeasures judge_behaviour(const MapRun& run, const RunTruth& truth) {
  std::map<Timestamp, const FrameReport*> reports;
  int losses = 0, trusted = 0;
  for (const MappedFrame& frame : run.frames) {
    if (!frame.report) continue;
    reports[frame.time] = &*frame.report;
    losses += frame.report->has(SessionEvent::pose_lost) ? 1 : 0;
    trusted += frame.report->health.verdict == Verdict::trusted ? 1 : 0;
  }
  BehaviourMeasures measures;
  if (run.frames.empty()) return measures;
  measures.first_pose = seconds_to_first_pose(run);
  measures.losses = losses;
  measures.trusted_share = share(trusted, static_cast<int>(run.frames.size()));
  measures.keyframes = count_frames(run.frames).keyframes;
  if (truth.map) note_trust(reports, errors_in_map(run.causal, truth.poses, *truth.map), measures);
  return measures;
}

}  // namespace

RunMeasures judge(const MapRun& run, const RunTruth& truth) {
  RunMeasures measures;
  measures.final_poses = judge_trajectory(run.final, run.frames.size(), truth);
  measures.causal_poses = judge_trajectory(run.causal, run.frames.size(), truth);
  measures.behaviour = judge_behaviour(run, truth);
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
    const auto aligned_run = absolute_trajectory_error(pairs, Scale::fixed);
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

}  // namespace byre::cli
