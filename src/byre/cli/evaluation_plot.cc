#include "byre/cli/evaluation_plot.h"

#include "byre/cli/benchmark_chart.h"
#include "byre/cli/formatted.h"

namespace byre::cli {
namespace {

constexpr const char* kTruthColour = "#b8b8b4";
constexpr const char* kEstimateColour = "#0072b2";
constexpr double kTruthWidth = 5.0;  // pixels, to be seen beneath the estimate

using Line = std::vector<std::vector<Eigen::Vector2d>>;

Timestamp longest_step(const std::vector<PosePair>& pairs) {
  Timestamp longest = std::chrono::milliseconds(500);
  if (pairs.size() < 2) return longest;
  const Timestamp mean = (pairs.back().time - pairs.front().time) / static_cast<int>(pairs.size() - 1);
  return std::max(longest, 5 * mean);
}

// Broken where poses are far apart in time.
template <typename PointOf>
Line line_through(const std::vector<PosePair>& pairs, PointOf point_of) {
  const Timestamp longest = longest_step(pairs);
  Line line;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (i == 0 || pairs[i].time - pairs[i - 1].time > longest) line.emplace_back();
    line.back().push_back(point_of(i));
  }
  return line;
}

Chart path_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs, bool y_points_down) {
  const auto from_above = [y_points_down](const Eigen::Vector3d& position) {
    return Eigen::Vector2d(position.x(), y_points_down ? position.z() : position.y());
  };
  const Similarity& truth_from_estimate = report.ate->truth_from_estimate;
  Chart chart;
  chart.title = "Path from above";
  chart.subtitle = formatted("%d poses with truth, %.2f m of true path", report.pairs, report.true_path);
  chart.x_label = "x [m]";
  chart.y_label = y_points_down ? "z [m]" : "y [m]";
  chart.equal_scales = true;
  chart.series = {
      {"truth", kTruthColour, kTruthWidth,
       line_through(pairs, [&](std::size_t i) { return from_above(pairs[i].true_world_from_body.translation); })},
      {"estimate", kEstimateColour, 1.6, line_through(pairs, [&](std::size_t i) {
         return from_above(truth_from_estimate * pairs[i].estimated_world_from_body.translation);
       })}};
  return chart;
}

Chart error_chart(const EvaluationReport& report, const std::vector<PosePair>& pairs) {
  Chart chart;
  chart.title = "Error of the position over time";
  chart.subtitle =
      formatted("root mean square %.4f m, largest %.4f m", report.ate->translation.rmse, report.ate->translation.max);
  chart.x_label = "time [s]";
  chart.y_label = "error [m]";
  chart.series = {{"estimate", kEstimateColour, 1.6, line_through(pairs, [&](std::size_t i) {
                     return Eigen::Vector2d(to_seconds(pairs[i].time - pairs.front().time), report.ate->errors[i]);
                   })}};
  return chart;
}

}  // namespace

std::string evaluation_plot(const EvaluationReport& report, const Trajectory& estimate, const Trajectory& truth,
                            bool y_points_down) {
  const std::vector<PosePair> pairs = associate(estimate, truth, report.protocol.association);
  return to_svg({path_chart(report, pairs, y_points_down), error_chart(report, pairs)});
}

}  // namespace byre::cli
