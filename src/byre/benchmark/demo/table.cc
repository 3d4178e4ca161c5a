#include "byre/benchmark/demo/table.h"

#include "byre/base/enum_names.h"

#include <functional>

#include <fmt/core.h>

namespace byre {
namespace {

// A table row: the figure that arms are compared by, and its text.
struct RowKind {
  std::string measure;
  std::function<Figure(const DemoArm&)> figure;
  std::function<std::string(const DemoArm&)> text;  // for non-empty figures
  bool more_is_better = false;
};

std::string percent(double share) {
  return fmt::format("{:.1f}", 1e2 * share);
}

// One decimal below a metre, none above.
std::string centimetres(double metres) {
  return fmt::format("{:.{}f}", 1e2 * metres, metres < 1.0 ? 1 : 0);
}

RowKind share_row(const char* measure, const std::function<Figure(const DemoArm&)>& share) {
  return {measure, share, [share](const DemoArm& arm) { return percent(*share(arm)); }, true};
}

RowKind error_row(const char* measure, TrajectoryMeasures RunMeasures::*poses) {
  const auto rmse = [poses](const DemoArm& arm) { return (arm.measures.*poses).map_error; };
  return {measure, rmse, [poses](const DemoArm& arm) {
            const TrajectoryMeasures& measures = arm.measures.*poses;
            return centimetres(*measures.map_error) + ", max " + centimetres(*measures.map_error_max);
          }};
}

RowKind shape_row() {
  return {"Path after alignment (ATE, RMSE), cm: published, final",
          [](const DemoArm& arm) { return arm.measures.causal_poses.ate; },
          [](const DemoArm& arm) {
            const Figure final_ate = arm.measures.final_poses.ate;
            return centimetres(*arm.measures.causal_poses.ate) + ", " + (final_ate ? centimetres(*final_ate) : "-");
          }};
}

RowKind time_row() {
  return {"Time per frame, ms: mean, 99th percentile",
          [](const DemoArm& arm) { return arm.measures.cost.frame_ms_mean; },
          [](const DemoArm& arm) {
            const CostMeasures& cost = arm.measures.cost;
            return fmt::format("{:.0f}, {:.0f}", *cost.frame_ms_mean, *cost.frame_ms_p99);
          }};
}

// A figure of positions on the plan, of the arms with a map.
std::function<Figure(const DemoArm&)> on_the_plan(double PlanFigures::*figure) {
  return [figure](const DemoArm& arm) { return arm.is_on_plan() ? Figure(plan_figures(arm).*figure) : Figure(); };
}

RowKind found_row() {
  return {"First trusted position after, s", [](const DemoArm& arm) { return plan_figures(arm).found_s; },
          [](const DemoArm& arm) { return fmt::format("{:.1f}", *plan_figures(arm).found_s); }};
}

RowKind median_row() {
  return {"Median error of published positions, cm", [](const DemoArm& arm) { return plan_figures(arm).median_error; },
          [](const DemoArm& arm) { return centimetres(*plan_figures(arm).median_error); }};
}

std::vector<RowKind> row_kinds() {
  const auto wrong = [](const DemoArm& arm) { return arm.is_on_plan() ? Figure(plan_figures(arm).wrong) : Figure(); };
  return {found_row(),
          share_row("Frames with a position on the plan, %",
                    [](const DemoArm& arm) { return Figure(plan_figures(arm).placed_share); }),
          share_row("Frames with a position within 10 cm of the truth, %",
                    [](const DemoArm& arm) { return Figure(plan_figures(arm).close_share); }),
          share_row("Frames reported as trusted, %", on_the_plan(&PlanFigures::trusted_share)),
          {"Frames trusted with an error above 20 cm", wrong,
           [wrong](const DemoArm& arm) { return fmt::format("{:.0f}", *wrong(arm)); }},
          median_row(),
          error_row("Error of published positions (RMSE), cm", &RunMeasures::causal_poses),
          error_row("Error of final positions (RMSE), cm", &RunMeasures::final_poses),
          shape_row(),
          time_row()};
}

// Marks the best arm and those with the same text.
DemoRow row_of(const RowKind& kind, const std::vector<DemoArm>& arms) {
  DemoRow row{kind.measure, {}};
  const DemoArm* best = nullptr;
  for (const DemoArm& arm : arms) {
    const Figure figure = kind.figure(arm);
    row.cells.push_back({figure ? kind.text(arm) : "-", false});
    if (!figure) continue;
    const bool is_better =
        best == nullptr || (kind.more_is_better ? *figure > *kind.figure(*best) : *figure < *kind.figure(*best));
    if (is_better) best = &arm;
  }
  if (best == nullptr) return row;
  const std::string best_text = kind.text(*best);
  for (DemoCell& cell : row.cells) cell.is_best = cell.text == best_text;
  return row;
}

}  // namespace

std::vector<DemoRow> demo_table(const std::vector<DemoArm>& arms) {
  std::vector<DemoRow> rows;
  for (const RowKind& kind : row_kinds()) rows.push_back(row_of(kind, arms));
  return rows;
}

std::string shown_name(Arm arm) {
  return std::string(name_among<Arm::hybrid>({"No map", "Localise only", "Hybrid"}, arm));
}

std::string to_text(const std::vector<DemoRow>& rows, const std::vector<DemoArm>& arms) {
  constexpr const char* kCell = "  {:>18}";
  constexpr const char* kMeasure = "{:60}";
  std::string text = fmt::format(kMeasure, "");
  for (const DemoArm& arm : arms) text += fmt::format(kCell, shown_name(arm.arm));
  text += "\n";
  for (const DemoRow& row : rows) {
    text += fmt::format(kMeasure, row.measure);
    for (const DemoCell& cell : row.cells) text += fmt::format(kCell, cell.text);
    text += "\n";
  }
  return text;
}

}  // namespace byre
