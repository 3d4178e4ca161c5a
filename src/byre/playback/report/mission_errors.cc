#include "byre/playback/report/mission_errors.h"

#include <algorithm>

#include <Eigen/Cholesky>

namespace byre {
namespace {

std::vector<PoseError> errors_with(Verdict verdict, const RunResult& run, const std::vector<PoseError>& causal) {
  std::vector<PoseError> chosen;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(causal, frame.time);
    if (error != nullptr && frame.report->health.verdict == verdict) chosen.push_back(*error);
  }
  return chosen;
}

bool is_far(const PoseError& error) {
  return error.position() > kFarMetres;
}

// Duration from the first to the last frame of an episode; 0 for a single frame.
double longest_wrong_trust(const RunResult& run, const std::vector<PoseError>& trusted) {
  double longest_s = 0.0;
  const PlayedFrame* first = nullptr;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(trusted, frame.time);
    if (error == nullptr || !is_far(*error)) {
      first = nullptr;
      continue;
    }
    if (first == nullptr) first = &frame;
    longest_s = std::max(longest_s, to_seconds(frame.time - first->time));
  }
  return longest_s;
}

// Compares position errors with covariances: both refer to a small motion in the body frame.
std::optional<double> share_within_bound(const RunResult& run, const std::vector<PoseError>& causal) {
  constexpr double kBound95 = 7.815;  // 95 % quantile of chi-square with three degrees of freedom
  int within = 0;
  int judged = 0;
  for (const PlayedFrame& frame : run.frames) {
    const PoseError* const error = find_error(causal, frame.time);
    if (error == nullptr) continue;
    const Eigen::Matrix3d covariance = frame.report->covariance.topLeftCorner<3, 3>();
    if (covariance.trace() <= 0.0) continue;  // first pose of a map: exact by definition
    const Eigen::Vector3d position = error->delta.head<3>();
    ++judged;
    within += position.dot(covariance.ldlt().solve(position)) <= kBound95 ? 1 : 0;
  }
  if (judged == 0) return std::nullopt;
  return static_cast<double>(within) / judged;
}

// Errors by verdict, from the causal errors.
void judge_trust(const RunResult& run, MissionErrors& errors) {
  errors.trusted = errors_with(Verdict::trusted, run, errors.causal);
  errors.degraded = errors_with(Verdict::degraded, run, errors.causal);
  errors.wrongly_trusted = static_cast<int>(std::ranges::count_if(errors.trusted, is_far));
  errors.longest_wrong_trust_s = longest_wrong_trust(run, errors.trusted);
}

std::vector<PoseError> errors_when_aligned(const Trajectory& estimate, const Trajectory& truth, Scale scale) {
  const auto error = absolute_trajectory_error(associate(estimate, truth, {}), scale);
  if (!error) return {};
  return errors_in_map(estimate, truth, {error->truth_from_estimate, 0});
}

}  // namespace

MissionErrors mission_errors(const RunResult& run, const MapAlignment& alignment, const Trajectory& truth) {
  MissionErrors errors;
  errors.in_map_frame = true;
  errors.alignment_poses = alignment.poses;
  errors.causal = errors_in_map(run.causal, truth, alignment);
  errors.final = errors_in_map(run.final, truth, alignment);
  judge_trust(run, errors);
  errors.within_bound = share_within_bound(run, errors.causal);
  errors.map = errors_of_map(alignment);
  errors.within_bound_without_map_error = share_within_bound(run, errors_relative_to_map(run.causal, truth, alignment));
  return errors;
}

MissionErrors aligned_errors(const RunResult& run, const Trajectory& truth, Scale scale) {
  MissionErrors errors;
  errors.causal = errors_when_aligned(run.causal, truth, scale);
  errors.final = errors_when_aligned(run.final, truth, scale);
  judge_trust(run, errors);
  return errors;
}

}  // namespace byre
