#include "byre/playback/report/evaluation_report.h"

#include "byre/base/report_row.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <string_view>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

double to_milliseconds(Timestamp time) {
  return 1e3 * to_seconds(time);
}

std::string_view name_of(PoseAlignment alignment) {
  switch (alignment) {
    case PoseAlignment::se3:
      return "se3";
    case PoseAlignment::sim3:
      return "sim3";
    case PoseAlignment::origin:
      return "origin";
    case PoseAlignment::none:
      return "none";
  }
  return "";
}

std::string describe_alignment(const EvaluationReport& report) {
  if (report.protocol.alignment == PoseAlignment::none) return "none, estimate and truth are in the same frame";
  if (report.protocol.alignment == PoseAlignment::origin)
    return "origin: the first pose equals the true one, including rotation";
  if (!report.ate) return "impossible: collinear positions, or fewer than three";
  if (report.protocol.alignment == PoseAlignment::se3) return "SE(3) over all pairs (Umeyama)";
  return fmt::format("Sim(3) over all pairs (Umeyama), scale {:.6f}", report.ate->truth_from_estimate.scale);
}

std::string caveat_row(const EvaluationReport& report) {
  const PoseAlignment alignment = report.protocol.alignment;
  if (!is_nearly_straight(report) || (alignment != PoseAlignment::se3 && alignment != PoseAlignment::sim3)) return "";
  return fmt::format(
      "caveat       the path is nearly a line, {:.3g} m long and {:.3g} m wide. The rotation of the alignment about "
      "this line is\n             undetermined, so errors across it and of rotation are arbitrary (not with "
      "--alignment origin)\n",
      report.true_spread[0], report.true_spread[1]);
}

std::string describe_association(const EvaluationReport& report) {
  const AssociationOptions& options = report.protocol.association;
  return fmt::format("truth interpolated in gaps up to {:g} ms, else its nearest sample within {:g} ms: {} pairs",
                     to_milliseconds(options.max_gap), to_milliseconds(options.max_difference), report.pairs);
}

std::string describe_coverage(const EvaluationReport& report) {
  if (!report.coverage) return "unknown: fewer than two poses, and no frames given";
  return fmt::format("{:.1f} % ({} of {} ", 100.0 * report.coverage->share(), report.coverage->with_pose,
                     report.coverage->expected) +
         report.coverage_source + ")";
}

std::string header(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  return row("estimate", fmt::format("{}, {} poses", estimate_file, report.estimated_poses)) +
         row("truth", fmt::format("{}, {} poses", truth_file, report.true_poses)) +
         row("poses", report.protocol.label) + row("alignment", describe_alignment(report)) +
         row("association", describe_association(report)) +
         row("time offset",
             fmt::format("{:g} s, added to the truth's time", to_seconds(report.protocol.association.time_offset))) +
         row("coverage", describe_coverage(report)) + row("true path", fmt::format("{:.2f} m", report.true_path)) +
         caveat_row(report);
}

std::string ate_rpe_row(const char* name, const ErrorStatistics& errors) {
  if (errors.count == 0) return fmt::format("{:22} no pair of poses at this distance\n", name);
  return fmt::format("{:22} {:9.5f} {:9.5f} {:9.5f} {:9.5f} {:9.5f} {:8}\n", name, errors.rmse, errors.mean,
                     errors.median, errors.p95, errors.max, errors.count);
}

Json to_json(const ErrorStatistics& errors) {
  if (errors.count == 0) return nullptr;
  return {{"rmse", errors.rmse}, {"mean", errors.mean}, {"median", errors.median},
          {"p95", errors.p95},   {"max", errors.max},   {"count", errors.count}};
}

Json to_json(const RelativePoseError& error) {
  return {{"translation_m", to_json(error.translation)}, {"rotation_deg", to_json(error.rotation)}};
}

std::string segment_row(const std::string& name, const SegmentError& error) {
  return fmt::format("{:22} {:9.4f} % {:11.6f} deg/m {:8} segments\n", name, 1e2 * error.translation, error.rotation,
                     error.count);
}

std::string segment_rows(const SegmentErrors& segments) {
  if (segments.all.count == 0) return "segments (KITTI)       none, the path is shorter than 100 m\n";
  std::string text = segment_row("segments (KITTI)", segments.all);
  for (const SegmentError& error : segments.by_length)
    text += segment_row(fmt::format("  of {:.0f} m", error.length), error);
  return text;
}

Json to_json(const SegmentError& error) {
  if (error.count == 0) return nullptr;
  return {
      {"translation_percent", 1e2 * error.translation}, {"rotation_deg_per_m", error.rotation}, {"count", error.count}};
}

Json to_json(const SegmentErrors& segments) {
  Json json = {{"all", to_json(segments.all)}, {"by_length_m", Json::object()}};
  for (const SegmentError& error : segments.by_length) {
    json["by_length_m"][fmt::format("{:.0f}", error.length)] = to_json(error);
  }
  return json;
}

Json to_json(const Similarity& truth_from_estimate) {
  const Eigen::Vector3d& t = truth_from_estimate.target_from_source.translation;
  const Eigen::Quaterniond& q = truth_from_estimate.target_from_source.rotation;
  return {{"scale", truth_from_estimate.scale},
          {"translation_m", {t.x(), t.y(), t.z()}},
          {"rotation_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
}

Json protocol_json(const EvaluationProtocol& protocol) {
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

std::string to_text(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  std::string text = header(report, estimate_file, truth_file) + "\n";
  text +=
      fmt::format("{:22} {:>9} {:>9} {:>9} {:>9} {:>9} {:>8}\n", "", "rmse", "mean", "median", "p95", "max", "count");
  if (report.ate) {
    text += ate_rpe_row("ATE            m", report.ate->translation) +
            ate_rpe_row("ATE            degrees", report.ate->rotation);
  }
  text += ate_rpe_row("RPE 1 frame    m", report.rpe_frame.translation);
  text += ate_rpe_row("RPE 1 frame    degrees", report.rpe_frame.rotation);
  text += ate_rpe_row("RPE 1 s        m", report.rpe_second.translation);
  text += ate_rpe_row("RPE 1 s        degrees", report.rpe_second.rotation);
  text += ate_rpe_row("RPE 1 m        m", report.rpe_metre.translation);
  text += ate_rpe_row("RPE 1 m        degrees", report.rpe_metre.rotation);
  return text + segment_rows(report.segments);
}

std::string to_json(const EvaluationReport& report, const std::string& estimate_file, const std::string& truth_file) {
  const Json json = {
      {"protocol", protocol_json(report.protocol)},
      {"estimate", {{"file", estimate_file}, {"poses", report.estimated_poses}}},
      {"truth", {{"file", truth_file}, {"poses", report.true_poses}}},
      {"pairs", report.pairs},
      {"true_path_m", report.true_path},
      {"true_spread_m", {report.true_spread[0], report.true_spread[1], report.true_spread[2]}},
      {"is_nearly_a_line", is_nearly_straight(report)},
      {"coverage", coverage_json(report)},
      {"ate", ate_json(report.ate)},
      {"rpe",
       {{"1_frame", to_json(report.rpe_frame)},
        {"1_s", to_json(report.rpe_second)},
        {"1_m", to_json(report.rpe_metre)}}},
      {"segments", to_json(report.segments)},
  };
  return dump_json(json, 2) + "\n";
}

}  // namespace byre
