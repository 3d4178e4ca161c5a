#include "byre/playback/report/evaluation_report.h"

#include "byre/base/enum_names.h"

#include <string_view>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string_view name_of(PoseAlignment alignment) {
  return name_among<PoseAlignment::none>({"se3", "sim3", "origin", "none"}, alignment);
}

std::string_view describe_alignment(const EvaluationReport& evaluation) {
  return name_among<PoseAlignment::none>(
      {"[{?ate}SE(3) over all pairs (Umeyama)|impossible: collinear positions, or fewer than three]",
       "[Sim(3) over all pairs (Umeyama), scale {ate.truth_from_estimate.scale:.6f}"
       "|impossible: collinear positions, or fewer than three]",
       "origin: the first pose equals the true one, including rotation",
       "none, estimate and truth are in the same frame"},
      evaluation.protocol.alignment);
}

bool has_arbitrary_rotation(const EvaluationReport& evaluation) {
  const PoseAlignment alignment = evaluation.protocol.alignment;
  return is_nearly_straight(evaluation) && (alignment == PoseAlignment::se3 || alignment == PoseAlignment::sim3);
}

Json statistics_json(const ErrorStatistics& errors) {
  if (errors.count == 0) return nullptr;
  return {{"rmse", errors.rmse}, {"mean", errors.mean}, {"median", errors.median},
          {"p95", errors.p95},   {"max", errors.max},   {"count", errors.count}};
}

Json relative_error_json(const RelativePoseError& error) {
  return {{"translation_m", statistics_json(error.translation)}, {"rotation_deg", statistics_json(error.rotation)}};
}

Json segment_json(const SegmentError& error) {
  if (error.count == 0) return nullptr;
  return {
      {"translation_percent", 1e2 * error.translation}, {"rotation_deg_per_m", error.rotation}, {"count", error.count}};
}

Json segments_json(const SegmentErrors& segments) {
  Json json = {{"all", segment_json(segments.all)}, {"by_length_m", Json::object()}};
  for (const SegmentError& error : segments.by_length) {
    json["by_length_m"][fmt::format("{:.0f}", error.length)] = segment_json(error);
  }
  return json;
}

Json similarity_json(const Similarity& truth_from_estimate) {
  const auto& [scale, pose] = truth_from_estimate;
  return {{"scale", scale},
          {"translation_m", list_json(pose.translation)},
          {"rotation_xyzw", list_json(pose.rotation.coeffs())}};
}

Json evaluation_protocol_json(const EvaluationProtocol& protocol) {
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
  return {{"translation_m", statistics_json(ate->translation)},
          {"rotation_deg", statistics_json(ate->rotation)},
          {"truth_from_estimate", similarity_json(ate->truth_from_estimate)}};
}

void add_header(const EvaluationReport& evaluation, Report& report) {
  const AssociationOptions& association = evaluation.protocol.association;
  report.row("estimate", "{estimate.file}, {estimate.poses} poses");
  report.row("truth", "{truth.file}, {truth.poses} poses");
  report.row("poses", "{protocol.poses}");
  report.row("alignment", describe_alignment(evaluation));
  report.row("association",
             "truth interpolated in gaps up to {gap_ms:g} ms, else its nearest sample within {nearest_ms:g} ms: "
             "{pairs} pairs",
             {{"gap_ms", 1e3 * to_seconds(association.max_gap)},
              {"nearest_ms", 1e3 * to_seconds(association.max_difference)}});
  report.row("time offset", "{protocol.truth_time_offset_s:g} s, added to the truth's time");
  report.row("coverage",
             "[{coverage.share*100:.1f} % ({coverage.with_pose} of {coverage.expected} {coverage.expected_are})"
             "|unknown: fewer than two poses, and no frames given]");
  report.row("true path", "{true_path_m:.2f} m");
  if (!has_arbitrary_rotation(evaluation)) return;
  report.row("caveat",
             "the path is nearly a line, {true_spread_m.0:.3g} m long and {true_spread_m.1:.3g} m wide. "
             "The rotation of the alignment about this line is");
  report.row("", "undetermined, so errors across it and of rotation are arbitrary (not with --alignment origin)");
}

void add_statistics(const char* label, const Json& errors, Report& report) {
  for (const auto& [key, unit] : {std::pair("translation_m", "m"), std::pair("rotation_deg", "degrees")}) {
    Json figures = errors[key];
    figures["label"] = fmt::format("{:14} {}", label, unit);
    report.line(
        "{label:22} [{rmse:9.5f} {mean:9.5f} {median:9.5f} {p95:9.5f} {max:9.5f} {count:8}"
        "|no pair of poses at this distance]",
        figures);
  }
}

void add_segment(const std::string& label, Json segment, Report& report) {
  segment["label"] = label;
  report.line("{label:22} {translation_percent:9.4f} % {rotation_deg_per_m:11.6f} deg/m {count:8} segments", segment);
}

void add_segments(Report& report) {
  const Json segments = report.figures["segments"];
  if (segments["all"].is_null()) return report.line("segments (KITTI)       none, the path is shorter than 100 m");
  add_segment("segments (KITTI)", segments["all"], report);
  for (const auto& [length, segment] : segments["by_length_m"].items()) {
    add_segment("  of " + length + " m", segment, report);
  }
}

}  // namespace

Report evaluation_report(const EvaluationReport& evaluation, const std::string& estimate_file,
                         const std::string& truth_file) {
  Report report{{{"protocol", evaluation_protocol_json(evaluation.protocol)},
                 {"estimate", {{"file", estimate_file}, {"poses", evaluation.estimated_poses}}},
                 {"truth", {{"file", truth_file}, {"poses", evaluation.true_poses}}},
                 {"pairs", evaluation.pairs},
                 {"true_path_m", evaluation.true_path},
                 {"true_spread_m", list_json(evaluation.true_spread)},
                 {"is_nearly_a_line", is_nearly_straight(evaluation)},
                 {"coverage", coverage_json(evaluation)},
                 {"ate", ate_json(evaluation.ate)},
                 {"rpe",
                  {{"1_frame", relative_error_json(evaluation.rpe_frame)},
                   {"1_s", relative_error_json(evaluation.rpe_second)},
                   {"1_m", relative_error_json(evaluation.rpe_metre)}}},
                 {"segments", segments_json(evaluation.segments)}}};
  add_header(evaluation, report);
  report.line("");
  report.line("                            rmse      mean    median       p95       max    count");
  if (evaluation.ate) add_statistics("ATE", report.figures["ate"], report);
  add_statistics("RPE 1 frame", report.figures["rpe"]["1_frame"], report);
  add_statistics("RPE 1 s", report.figures["rpe"]["1_s"], report);
  add_statistics("RPE 1 m", report.figures["rpe"]["1_m"], report);
  add_segments(report);
  return report;
}

}  // namespace byre
