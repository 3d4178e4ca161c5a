#include "byre/assessment/finish_report.h"

#include "byre/input/formatted.h"

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string listing(const char* format, const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ", ") + formatted(format, value);
  return text;
}

std::string describe_loops(const FinishReport& report) {
  if (report.loops == 0) return "no more found";
  return formatted("%d more, drifted by ", report.loops) + listing("%.1f", report.loop_drifts) + " px, now off by " +
         listing("%.3f", report.loop_residuals) + " m";
}

std::string describe_faults(const std::vector<std::string>& faults) {
  if (faults.empty()) return "none";
  return formatted("%zu; the first: ", faults.size()) + faults.front();
}

Json to_json(const MapQuality& quality) {
  return {{"keyframes", quality.keyframes},
          {"points", quality.points},
          {"observations", quality.observations},
          {"reprojection_median_px", quality.reprojection_median},
          {"reprojection_p95_px", quality.reprojection_p95},
          {"parts", quality.parts}};
}

}  // namespace

std::string to_text(const Finishing& finishing) {
  const FinishReport& report = finishing.report;
  const MapQuality& before = report.before;
  const MapQuality& after = report.after;
  std::string text = row("last loops", describe_loops(report));
  text += row("removed",
              formatted("%d redundant keyframes, %d weak points", report.keyframes_removed, report.points_removed));
  text +=
      row("pixel error", formatted("median %.3f -> %.3f px, 95 %% within %.3f -> %.3f px", before.reprojection_median,
                                   after.reprojection_median, before.reprojection_p95, after.reprojection_p95));
  text += row("parts", formatted("%d -> %d that share no points", before.parts, after.parts));
  text += row("faults", describe_faults(finishing.faults));
  text +=
      row("finishing", formatted(finishing.cut_short ? "%.1f s, cut short; \"byre refine\" goes on with it" : "%.1f s",
                                 finishing.seconds));
  return text;
}

Json to_json(const Finishing& finishing) {
  const FinishReport& report = finishing.report;
  return {{"loops", report.loops},
          {"loop_drifts_px", report.loop_drifts},
          {"loop_residuals_m", report.loop_residuals},
          {"keyframes_removed", report.keyframes_removed},
          {"points_removed", report.points_removed},
          {"before", to_json(report.before)},
          {"after", to_json(report.after)},
          {"faults", finishing.faults},
          {"cut_short", finishing.cut_short},
          {"wall_s", finishing.seconds}};
}

}  // namespace byre
