#include "byre/benchmark/demo/findings.h"

#include "byre/geometry/median.h"
#include "byre/playback/report/mission_report.h"

#include <algorithm>

namespace byre {

PlanFigures plan_figures(const DemoArm& arm) {
  PlanFigures figures;
  std::vector<double> errors;
  int trusted = 0;
  for (const DemoMoment& moment : arm.moments) {
    if (!moment.error) continue;
    errors.push_back(*moment.error);
    if (moment.verdict != Verdict::trusted || !arm.is_on_plan()) continue;
    ++trusted;
    figures.wrong += *moment.error > kFarMetres ? 1 : 0;
    if (!figures.found_s) figures.found_s = moment.time_s;
  }
  if (errors.empty()) return figures;
  const auto frames = static_cast<double>(arm.moments.size());
  const auto close = std::ranges::count_if(errors, [](double error) { return error <= kCloseMetres; });
  const double placed = static_cast<double>(errors.size());
  const double median = median_or(std::move(errors), 0.0);
  if (!arm.is_on_plan()) {
    figures.aligned_median_error = median;
    return figures;
  }
  figures.placed_share = placed / frames;
  figures.close_share = static_cast<double>(close) / frames;
  figures.trusted_share = trusted / frames;
  figures.median_error = median;
  return figures;
}

}  // namespace byre
