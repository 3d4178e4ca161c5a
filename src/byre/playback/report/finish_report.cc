#include "byre/playback/report/finish_report.h"

namespace byre {
namespace {

nlohmann::ordered_json quality_json(const MapQuality& quality) {
  return {{"keyframes", quality.keyframes},
          {"points", quality.points},
          {"observations", quality.observations},
          {"reprojection_median_px", quality.reprojection_median},
          {"reprojection_p95_px", quality.reprojection_p95},
          {"parts", quality.parts}};
}

}  // namespace

Report finish_report(const FinishResult& finishing) {
  const FinishReport& finish = finishing.report;
  Report report{{{"loops", finish.loops},
                 {"loop_drifts_px", finish.loop_drifts},
                 {"loop_residuals_m", finish.loop_residuals},
                 {"keyframes_removed", finish.keyframes_removed},
                 {"points_removed", finish.points_removed},
                 {"before", quality_json(finish.before)},
                 {"after", quality_json(finish.after)},
                 {"faults", finishing.faults},
                 {"cut_short", finishing.cut_short},
                 {"wall_s", finishing.seconds}}};
  report.detail("last loops",
                "[{?loops}{loops} closed; drift {loop_drifts_px:.1f} px, residual {loop_residuals_m:.3f} m|none]");
  report.detail("removed", "{keyframes_removed} redundant keyframes, {points_removed} weak points");
  report.detail("pixel error",
                "median {before.reprojection_median_px:.3f} -> {after.reprojection_median_px:.3f} px, "
                "95 % within {before.reprojection_p95_px:.3f} -> {after.reprojection_p95_px:.3f} px");
  report.detail("parts", "{before.parts} -> {after.parts} without common points");
  report.row("faults", "{?faults}{#faults}; the first: {faults.0}");
  report.row("finishing", "{?cut_short}interrupted after {wall_s:.1f} s; continue with \"byre refine\"");
  report.detail("finishing", "{!cut_short}{wall_s:.1f} s");
  return report;
}

}  // namespace byre
