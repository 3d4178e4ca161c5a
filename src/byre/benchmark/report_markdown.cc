#include "byre/base/printable.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/benchmark/report.h"

#include <algorithm>
#include <sstream>

#include <fmt/core.h>

namespace byre {
namespace {

std::string number(double value, double scale, int digits) {
  return fmt::format("{:.{}f}", scale * value, digits);
}

// Mean, median and worst, or one figure if they agree; with the number of runs if some lack the figure.
template <typename Measures>
std::string cell(const std::vector<Measures>& runs, const Measure<Measures>& measure) {
  const std::optional<RunSummary> summary = summarise_runs(runs, measure);
  if (!summary) return kEmptyCell;
  const auto shown = [&measure](double value) { return number(value, measure.scale, measure.digits); };
  const std::string mean = shown(summary->mean), median = shown(summary->median), worst = shown(summary->worst);
  std::string text = mean;
  if (median != mean || worst != mean) text += " / " + median + " / " + worst;
  if (summary->runs < static_cast<int>(runs.size())) text += fmt::format(" ({} of {})", summary->runs, runs.size());
  return text;
}

template <typename Measures>
std::vector<std::string> cells_of(const std::vector<Measures>& runs, std::span<const Measure<Measures>> measures) {
  std::vector<std::string> cells;
  for (const Measure<Measures>& measure : measures) cells.push_back(cell(runs, measure));
  return cells;
}

std::vector<std::string> with_names(const std::string& first, const std::string& second,
                                    std::vector<std::string> cells) {
  cells.insert(cells.begin(), {first, second});
  return cells;
}

template <typename Measures>
MarkdownTable empty_table(std::span<const Measure<Measures>> measures) {
  std::vector<std::string> titles;
  for (const Measure<Measures>& measure : measures) titles.push_back(measure.title);
  return MarkdownTable(with_names("case", "arm", titles));
}

template <typename Measures>
void add_arms(const CaseResult& result, Measures RunMeasures::*part, std::span<const Measure<Measures>> measures,
              MarkdownTable& table) {
  for (const ArmResult& arm : result.arms) {
    std::vector<Measures> runs;
    for (const BenchmarkRunResult& run : arm.runs) runs.push_back(run.measures.*part);
    std::string name(name_of(arm.arm));
    std::ranges::replace(name, '_', ' ');
    table.add(with_names(result.what.name, name, cells_of(runs, measures)));
  }
}

void add_published(const std::string& case_name, const BenchmarkProtocol& protocol, MarkdownTable& table) {
  for (const PublishedFigures& published : protocol.published) {
    const auto found = published.of_case.find(case_name);
    if (found == published.of_case.end()) continue;
    const std::vector<TrajectoryMeasures> once = {found->second};
    table.add(with_names(case_name, "*" + published.name + "*", cells_of(once, trajectory_measures())));
  }
}

template <typename Measures>
std::string table_of(const BenchmarkResult& result, Measures RunMeasures::*part,
                     std::span<const Measure<Measures>> measures) {
  MarkdownTable table = empty_table(measures);
  for (const CaseResult& one : result.cases) add_arms(one, part, measures, table);
  return table.text();
}

std::string final_table(const BenchmarkResult& result, const BenchmarkProtocol& protocol) {
  MarkdownTable table = empty_table(trajectory_measures());
  for (const CaseResult& one : result.cases) {
    add_arms(one, &RunMeasures::final_poses, trajectory_measures(), table);
    add_published(one.what.name, protocol, table);
  }
  return table.text();
}

std::string alignment_text(const MapAlignment& alignment) {
  if (alignment.poses == 0) return "none: too few poses with truth";
  return fmt::format("{} poses", alignment.poses);
}

std::string maps_table(const BenchmarkResult& result) {
  MarkdownTable table({"map of", "keyframes", "points", "aligned to the truth by", "made in s"});
  for (const BuiltMap& map : result.maps) {
    table.add({map.recording, std::to_string(map.keyframes), std::to_string(map.points), alignment_text(map.alignment),
               fmt::format("{:.1f}", map.wall_seconds)});
  }
  return table.text();
}

std::string seeds_text(const BenchmarkProtocol& protocol) {
  std::string text;
  for (int i = 0; i < protocol.runs; ++i) text += (i > 0 ? ", " : "") + std::to_string(protocol.seed_of_run(i));
  return text;
}

std::string header(const BenchmarkResult& result, const BenchmarkProtocol& protocol, const BenchmarkSetting& setting) {
  std::ostringstream text;
  text << "# " << protocol.title << "\n\n";
  if (!protocol.about.empty()) text << protocol.about << "\n\n";
  text << "- **byre** " BYRE_VERSION ", protocol " << setting.protocol_file << ", recordings in " << setting.data
       << "\n"
       << "- **runs** " << protocol.runs << " per arm, seeds " << seeds_text(protocol)
       << (protocol.runs > 1 ? "; figures are mean / median / worst over the runs, or one if all are equal\n" : "\n")
       << "- **machine** " << setting.cores << " cores; pace " << name_of(setting.pace) << "\n"
       << "- **ATE** RMSE of position after SE(3) alignment of each run to the truth (Umeyama)\n"
       << "- **map error** RMSE, median and max of position in the frame of the offline map; only the map is aligned "
          "to the truth, once, by its own keyframes\n"
       << "- **coverage** share of the recording's frames with a pose; errors are over the poses with truth\n"
       << "- **RPE** RMSE over 1 frame, 1 s and 1 m of path\n";
  for (const auto& [name, value] : setting.changed_options) text << "- **option** " << name << ": " << value << "\n";
  if (result.stopped) text << "- **stopped early**: the figures cover the finished runs only\n";
  return text.str() + "\n";
}

std::string section(const std::string& title, const std::string& table) {
  return table.empty() ? "" : "## " + title + "\n\n" + table + "\n";
}

std::string skipped_list(const BenchmarkResult& result) {
  std::string text;
  for (const SkippedCase& skipped : result.skipped) text += "- " + skipped.name + ": " + skipped.reason + "\n";
  return text;
}

// Notes on the published results that are shown.
std::string notes(const BenchmarkResult& result, const BenchmarkProtocol& protocol) {
  std::string text;
  for (const PublishedFigures& published : protocol.published) {
    const bool is_shown = std::ranges::any_of(
        result.cases, [&published](const CaseResult& one) { return published.of_case.contains(one.what.name); });
    if (is_shown && !published.note.empty()) text += "- *" + published.name + "*: " + published.note + "\n";
  }
  return text.empty() ? "" : text + "\n";
}

}  // namespace

std::string to_markdown(const BenchmarkResult& result, const BenchmarkProtocol& protocol,
                        const BenchmarkSetting& setting) {
  return printable_lines(
      header(result, protocol, setting) +
      section("Final poses: as corrected after the last frame", final_table(result, protocol)) +
      notes(result, protocol) +
      section("Causal poses: as published with their frames",
              table_of(result, &RunMeasures::causal_poses, trajectory_measures())) +
      section("Behaviour, causal poses", table_of(result, &RunMeasures::behaviour, behaviour_measures())) +
      section("Cost", table_of(result, &RunMeasures::cost, cost_measures())) +
      section("Offline maps", maps_table(result)) + section("Skipped", skipped_list(result)));
}

}  // namespace byre
