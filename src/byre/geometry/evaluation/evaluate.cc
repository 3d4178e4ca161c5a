#include "byre/geometry/evaluation/evaluate.h"

#include <algorithm>

namespace byre {
namespace {

constexpr const char* kSpanSource =
    "frames expected from the time span of the truth and the median interval of the estimate";

// Aligns the first estimated pose with the true pose of its time.
Similarity origin_alignment(const PosePair& first) {
  return {1.0, first.true_world_from_body * inverse(first.estimated_world_from_body)};
}

std::optional<AbsoluteTrajectoryError> absolute_error(const std::vector<PosePair>& pairs, PoseAlignment alignment) {
  if (alignment == PoseAlignment::origin) return absolute_trajectory_error(pairs, origin_alignment(pairs.front()));
  if (alignment == PoseAlignment::none) return absolute_trajectory_error(pairs, Similarity{});
  return absolute_trajectory_error(pairs, alignment == PoseAlignment::sim3 ? Scale::free : Scale::fixed);
}

double true_path(const std::vector<PosePair>& pairs) {
  Trajectory truth;
  for (const PosePair& pair : pairs) truth.push_back({pair.time, pair.true_world_from_body});
  return path_length(truth);
}

}  // namespace

bool is_nearly_straight(const EvaluationReport& report) {
  constexpr double kThinnest = 0.01;     // share of the length; less is unevenness of a floor or of a hand-held path
  constexpr double kErrorsAcross = 3.0;  // least width that determines the rotation about the line, in position errors
  const double width = report.true_spread[1];
  const double error = report.ate ? report.ate->translation.rmse : 0.0;
  return width < std::max(kThinnest * report.true_spread[0], kErrorsAcross * error);
}

std::optional<EvaluationReport> evaluate(const Trajectory& estimate, const Trajectory& truth,
                                         const EvaluationProtocol& protocol,
                                         const std::optional<ExpectedFrames>& expected) {
  const std::vector<PosePair> pairs = associate(estimate, truth, protocol.association);
  if (pairs.empty()) return std::nullopt;
  EvaluationReport report;
  report.protocol = protocol;
  report.estimated_poses = static_cast<int>(estimate.size());
  report.true_poses = static_cast<int>(truth.size());
  report.pairs = static_cast<int>(pairs.size());
  report.true_path = true_path(pairs);
  report.coverage = expected ? coverage_of_frames(estimate, expected->times)
                             : coverage_of_span(estimate, truth, protocol.association.time_offset);
  report.coverage_source = expected ? expected->source : kSpanSource;
  report.ate = absolute_error(pairs, protocol.alignment);
  const double scale = report.ate ? report.ate->truth_from_estimate.scale : 1.0;
  report.rpe_frame = relative_pose_error_by_frame(pairs, scale);
  report.rpe_second = relative_pose_error_by_time(pairs, std::chrono::seconds(1), scale);
  report.rpe_metre = relative_pose_error_by_distance(pairs, 1.0, scale);
  report.segments = segment_errors(pairs, scale);
  report.true_spread = principal_spread(pairs);
  return report;
}

}  // namespace byre
