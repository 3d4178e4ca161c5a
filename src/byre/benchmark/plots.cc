#include "byre/benchmark/plots.h"

#include "byre/base/enum_names.h"
#include "byre/benchmark/evaluate_run.h"

#include <algorithm>
#include <chrono>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

constexpr const char* kEstimateColour = "#0072b2";
constexpr Timestamp kLongestStep = std::chrono::milliseconds(500);  // longer intervals between poses break the line

Timestamp longest_step(const std::vector<PosePair>& pairs) {
  if (pairs.size() < 2) return kLongestStep;
  const Timestamp mean = (pairs.back().time - pairs.front().time) / static_cast<int>(pairs.size() - 1);
  return std::max(kLongestStep, 5 * mean);
}

// The aligned estimate. Precondition: the report has an absolute error of these pairs.
std::vector<TracePoint> trace_of(const EvaluationReport& report, const std::vector<PosePair>& pairs) {
  std::vector<TracePoint> trace;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Vector3d& position = pairs[i].estimated_world_from_body.translation;
    trace.push_back({pairs[i].time, report.ate->truth_from_estimate * position, report.ate->errors[i]});
  }
  return trace;
}

Chart path_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs, bool y_points_down) {
  const auto from_above = [y_points_down](const Eigen::Vector3d& position) {
    return Eigen::Vector2d(position.x(), y_points_down ? position.z() : position.y());
  };
  const auto true_point = [&](const PosePair& pair) { return from_above(pair.true_world_from_body.translation); };
  const auto estimated_point = [&](const TracePoint& point) { return from_above(point.position_in_truth); };
  const Timestamp longest = longest_step(pairs);
  Chart chart;
  chart.title = "Path from above";
  chart.subtitle = fmt::format("{} poses with truth, {:.2f} m of true path", report.pairs, report.true_path);
  chart.x_label = "x [m]";
  chart.y_label = y_points_down ? "z [m]" : "y [m]";
  chart.equal_scales = true;
  chart.series = {{"truth", kTruthColour, kTruthWidth, line_through(pairs, longest, true_point)},
                  {"estimate", kEstimateColour, 1.6, line_through(trace_of(report, pairs), longest, estimated_point)}};
  return chart;
}

Chart error_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs) {
  const auto error_at = [begin = pairs.front().time](const TracePoint& point) {
    return Eigen::Vector2d(to_seconds(point.time - begin), point.error);
  };
  Chart chart;
  chart.title = "Position error over time";
  chart.subtitle =
      fmt::format("RMSE {:.4f} m, max {:.4f} m", report.ate->translation.rmse, report.ate->translation.max);
  chart.x_label = "time [s]";
  chart.y_label = "error [m]";
  chart.series = {
      {"estimate", kEstimateColour, 1.6, line_through(trace_of(report, pairs), longest_step(pairs), error_at)}};
  return chart;
}

std::string_view colour_of(Arm arm) {
  return name_among<Arm::hybrid>({"#0072b2", "#e69f00", "#c7322e"}, arm);
}

// Pixels. The hybrid's line is drawn last and is narrower, so that both stay visible where they coincide.
double width_of(Arm arm) {
  return arm == Arm::localise_only ? 3.4 : 1.6;
}

std::string shown_name(Arm arm) {
  std::string name(name_of(arm));
  std::ranges::replace(name, '_', ' ');
  return name;
}

// Horizontal axes of the truth: z points up in EuRoC, y points down in KITTI.
Eigen::Vector2d from_above(const Eigen::Vector3d& position, RecordingFormat format) {
  return {position.x(), format == RecordingFormat::kitti ? position.z() : position.y()};
}

std::string about(const CaseResult& result) {
  std::string text = result.what.recording;
  if (result.what.map) text += " on the map of " + *result.what.map;
  return text;
}

}  // namespace

Chart path_chart(const CaseResult& result) {
  Chart chart;
  chart.title = result.what.name + ": path from above";
  chart.subtitle =
      about(result) + "; final poses; no map: aligned to the truth; others: in the frame of the offline map";
  chart.x_label = "x [m]";
  chart.y_label = result.format == RecordingFormat::kitti ? "z [m]" : "y [m]";
  chart.equal_scales = true;
  const auto of_truth = [&result](const StampedPose& sample) {
    return from_above(sample.world_from_body.translation, result.format);
  };
  const auto of_trace = [&result](const TracePoint& point) {
    return from_above(point.position_in_truth, result.format);
  };
  chart.series.push_back({"truth", kTruthColour, kTruthWidth, line_through(result.truth, kLongestStep, of_truth)});
  for (const ArmResult& arm : result.arms) {
    chart.series.push_back({shown_name(arm.arm), std::string(colour_of(arm.arm)), width_of(arm.arm),
                            line_through(arm.final_trace, kLongestStep, of_trace)});
  }
  return chart;
}

Chart error_chart(const CaseResult& result) {
  constexpr double kMillimetres = 1e3;
  Chart chart;
  chart.title = result.what.name + ": position error over time";
  chart.subtitle = about(result) + "; causal poses; no map: after alignment; others: in the frame of the offline map";
  chart.x_label = "time [s]";
  chart.y_label = "error [mm]";
  chart.log_y = true;
  const Timestamp begin = result.truth.empty() ? Timestamp{0} : result.truth.front().time;
  const auto of_trace = [begin](const TracePoint& point) {
    return Eigen::Vector2d(to_seconds(point.time - begin), kMillimetres * point.error);
  };
  for (const ArmResult& arm : result.arms) {
    chart.series.push_back({shown_name(arm.arm), std::string(colour_of(arm.arm)), width_of(arm.arm),
                            line_through(arm.causal_trace, kLongestStep, of_trace)});
  }
  return chart;
}

std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down) {
  const std::vector<PosePair> pairs = associate(estimate, truth, report.protocol.association);
  return to_svg({path_chart(report, pairs, y_points_down), error_chart(report, pairs)});
}

}  // namespace byre
