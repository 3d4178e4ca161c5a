#include "byre/playback/report/finish_report.h"

#include "byre/base/report_row.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

std::string describe_loops(const FinishReport& report) {
  if (report.loops == 0) return "none";
  return fmt::format("{} closed; drift {:.1f} px, residual {:.3f} m", report.loops, fmt::join(report.loop_drifts, ", "),
                     fmt::join(report.loop_residuals, ", "));
}

std::string describe_faults(const std::vector<std::string>& faults) {
  if (faults.empty()) return "none";
  return fmt::format("{}; the first: ", faults.size()) + faults.front();
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

std::string to_text(const FinishResult& finishing) {
  const FinishReport& report = finishing.report;
  const MapQuality& before = report.before;
  const MapQuality& after = report.after;
  std::string text = row("last loops", describe_loops(report));
  text += row("removed",
              fmt::format("{} redundant keyframes, {} weak points", report.keyframes_removed, report.points_removed));
  text += row("pixel error",
              fmt::format("median {:.3f} -> {:.3f} px, 95 % within {:.3f} -> {:.3f} px", before.reprojection_median,
                          after.reprojection_median, before.reprojection_p95, after.reprojection_p95));
  text += row("parts", fmt::format("{} -> {} without common points", before.parts, after.parts));
  text += row("faults", describe_faults(finishing.faults));
  text += row("finishing", fmt::format("{:.1f} s{}", finishing.seconds,
                                       finishing.cut_short ? ", interrupted; continue with \"byre refine\"" : ""));
  return text;
}

Json to_json(const FinishResult& finishing) {
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
