#include "byre/cli/evaluation_report.h"

#include "byre/cli/formatted.h"

#include <sstream>
#include <string_view>

#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSpanSource = "frames that fit into the truth's span at the estimate's median interval";

double to_milliseconds(Timestamp time) {
  return 1e3 * to_seconds(time);
}

std::optional<AbsoluteTrajectoryError> absolute_error(const std::vector<PosePair>& pairs, Alignment alignment) {
  if (alignment == Alignment::none) return absolute_trajectory_error(pairs, Similarity{});
  return absolute_trajectory_error(pairs, alignment == Alignment::sim3 ? Scale::free : Scale::fixed);
}

double true_path(const std::vector<PosePair>& pairs) {
  Trajectory truth;
  for (const PosePair& pair : pairs) truth.push_back({pair.time, pair.true_world_from_body});
  return path_length(truth);
}

std::string_view name_of(Alignment alignment) {
  switch (alignment) {
    case Alignment::se3:
      return "se3";
    case Alignment::sim3:
      return "sim3";
    case Alignment::none:
      return "none";
  }
  return "";
}

std::string describe_alignment(const EvaluationReport& report) {
  if (report.protocol.alignment == Alignment::none) return "none, the estimate is taken to be in the truth's frame";
  if (!report.ate) return "impossible: the positions lie on a line, or there are fewer than three";
  if (report.protocol.alignment == Alignment::se3) return "SE(3) over all pairs (Umeyama)";
  return formatted("Sim(3) over all pairs (Umeyama), scale %.6f", report.ate->truth_from_estimate.scale);
}

std::string describe_association(const EvaluationReport& report) {
  const AssociationOptions& options = report.protocol.association;
  return formatted("truth interpolated in gaps up to %g ms, else its nearest sample within %g ms: %d pairs",
                   to_milliseconds(options.max_gap), to_milliseconds(options.max_difference), report.pairs);
}

std::string describe_coverage(const EvaluationReport& report) {
  if (!report.coverage) return "unknown: fewer than two poses, and no frames given";
  return formatted("%.1f %% (%d of %d ", 100.0 * report.coverage->share(), report.coverage->with_pose,
                   report.coverage->expected) +
         report.coverage_source + ")";
}

std::string header(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  std::ostringstream text;
  text << "estimate     " << estimate_file << ", " << report.estimated_poses << " poses\n"
       << "truth        " << truth_file << ", " << report.true_poses << " poses\n"
       << "poses        " << report.protocol.label << "\n"
       << "alignment    " << describe_alignment(report) << "\n"
       << "association  " << describe_association(report) << "\n"
       << "time offset  " << to_seconds(report.protocol.association.time_offset) << " s, added to the truth's time\n"
       << "coverage     " << describe_coverage(report) << "\n"
       << "true path    " << formatted("%.2f m", report.true_path) << "\n";
  return text.str();
}

std::string row(const char* name, const ErrorStatistics& errors) {
  if (errors.count == 0) return formatted("%-22s no pair of poses is that far apart\n", name);
  return formatted("%-22s %9.5f %9.5f %9.5f %9.5f %9.5f %8d\n", name, errors.rmse, errors.mean, errors.median,
                   errors.p95, errors.max, errors.count);
}

Json to_json(const ErrorStatistics& errors) {
  if (errors.count == 0) return nullptr;
  return {{"rmse", errors.rmse}, {"mean", errors.mean}, {"median", errors.median},
          {"p95", errors.p95},   {"max", errors.max},   {"count", errors.count}};
}

Json to_json(const RelativePoseError& error) {
  return {{"translation_m", to_json(error.translation)}, {"rotation_deg", to_json(error.rotation)}};
}

Json to_json(const Similarity& truth_from_estimate) {
  const Eigen::Vector3d& t = truth_from_estimate.target_from_source.translation;
  const Eigen::Quaterniond& q = truth_from_estimate.target_from_source.rotation;
  return {{"scale", truth_from_estimate.scale},
          {"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json protocol_json(const Protocol& protocol) {
  return {{"poses", protocol.label},
          {"alignment", name_of(protocol.alignment)},
          {"association",
           {{"interpolated_within_s", to_seconds(protocol.association.max_gap)},
            {"nearest_within_s", to_seconds(protocol.association.max_difference)}}},
          {"truth_time_offset_s", to_seconds(protocol.association.time_offset)}};
}

Json coverage_json(const EvaluationReport& report) {
  if (!report.coverage) return nullptr;
  return {{"share", report.coverage->share()},
          {"with_pose", report.coverage->with_pose},
          {"expected", report.coverage->expected},
          {"expected_are", report.coverage_source}};
}

Json ate_json(const std::optional<AbsoluteTrajectoryError>& ate) {
  if (!ate) return nullptr;
  return {{"translation_m", to_json(ate->translation)},
          {"rotation_deg", to_json(ate->rotation)},
          {"truth_from_estimate", to_json(ate->truth_from_estimate)}};
}

}  // namespace

std::optional<EvaluationReport> evaluate(const Trajectory& estimate, const Trajectory& truth, const Protocol& protocol,
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
  return report;
}

std::string to_text(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  std::string text = header(report, estimate_file, truth_file) + "\n";
  text += formatted("%-22s %9s %9s %9s %9s %9s %8s\n", "", "rmse", "mean", "median", "p95", "max", "count");
  if (report.ate) {
    text += row("ATE            m", report.ate->translation) + row("ATE            degrees", report.ate->rotation);
  }
  text += row("RPE 1 frame    m", report.rpe_frame.translation);
  text += row("RPE 1 frame    degrees", report.rpe_frame.rotation);
  text += row("RPE 1 s        m", report.rpe_second.translation);
  text += row("RPE 1 s        degrees", report.rpe_second.rotation);
  text += row("RPE 1 m        m", report.rpe_metre.translation);
  text += row("RPE 1 m        degrees", report.rpe_metre.rotation);
  return text;
}

std::string to_json(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  const Json json = {
      {"protocol", protocol_json(report.protocol)},
      {"estimate", {{"file", estimate_file}, {"poses", report.estimated_poses}}},
      {"truth", {{"file", truth_file}, {"poses", report.true_poses}}},
      {"pairs", report.pairs},
      {"true_path_m", report.true_path},
      {"coverage", coverage_json(report)},
      {"ate", ate_json(report.ate)},
      {"rpe",
       {{"1_frame", to_json(report.rpe_frame)},
        {"1_s", to_json(report.rpe_second)},
        {"1_m", to_json(report.rpe_metre)}}},
  };
  constexpr int kIndent = 2;
  return json.dump(kIndent, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace byre::cli
