#include "byre/base/printable.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/benchmark/speed.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <functional>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;
using SpeedFigure = std::function<std::optional<double>(const SpeedMeasures&)>;

double mean_frame_ms(const SpeedMeasures& run) {
  return run.stages.back().mean_ms;
}

// Figure of the median run, with the range over all runs if they differ.
std::string cell_with_range(const std::vector<SpeedMeasures>& runs, const SpeedMeasures& median,
                            const SpeedFigure& figure, int digits) {
  const auto shown = [digits](double value) { return fmt::format("{:.{}f}", value, digits); };
  std::optional<double> least, most;
  for (const SpeedMeasures& run : runs) {
    const std::optional<double> value = figure(run);
    if (!value) continue;
    least = std::min(*value, least.value_or(*value));
    most = std::max(*value, most.value_or(*value));
  }
  if (!figure(median)) return kEmptyCell;
  const std::string text = shown(*figure(median));
  return shown(*least) == shown(*most) ? text : text + " (" + shown(*least) + " to " + shown(*most) + ")";
}

std::string stage_table(const std::vector<SpeedMeasures>& runs, const SpeedMeasures& median) {
  MarkdownTable table({"wall time per frame, ms", "mean", "median", "95 %", "99 %", "worst"});
  for (std::size_t i = 0; i < frame_stages().size(); ++i) {
    std::vector<std::string> cells = {frame_stages()[i].name};
    for (double TimeSummary::*figure : {&TimeSummary::mean_ms, &TimeSummary::p50_ms, &TimeSummary::p95_ms,
                                        &TimeSummary::p99_ms, &TimeSummary::max_ms}) {
      cells.push_back(cell_with_range(
          runs, median, [&](const SpeedMeasures& run) { return run.stages[i].*figure; }, 2));
    }
    table.add(std::move(cells));
  }
  return table.text();
}

std::string cost_table(const SpeedCase& what, const std::vector<SpeedMeasures>& runs, const SpeedMeasures& median) {
  constexpr double kMega = 1e6;
  MarkdownTable table({"the whole run", "figure"});
  const auto add = [&](const char* name, int digits, const SpeedFigure& figure) {
    table.add({name, cell_with_range(runs, median, figure, digits)});
  };
  add("time to first pose, s", 2, [](const SpeedMeasures& run) { return run.first_pose_seconds; });
  add("CPU time, s", 2, [](const SpeedMeasures& run) { return run.cpu_seconds; });
  add("wall time, s", 2, [](const SpeedMeasures& run) { return run.wall_seconds; });
  add("peak memory, MB", 0, [](const SpeedMeasures& run) { return run.peak_memory_mb; });
  add("instructions per frame, millions", 1, [](const SpeedMeasures& run) -> std::optional<double> {
    if (!run.instructions || run.frames == 0) return std::nullopt;
    return static_cast<double>(*run.instructions) / kMega / run.frames;
  });
  add("keyframes", 0, [](const SpeedMeasures& run) { return run.keyframes; });
  if (what.method.frame_deadline_ms > 0.0) {
    add("frames late", 0, [](const SpeedMeasures& run) { return run.late; });
    add("frames with limited online points", 0, [](const SpeedMeasures& run) { return run.without_online_points; });
    add("frames without the right image", 0, [](const SpeedMeasures& run) { return run.with_left_alone; });
  }
  add("mapping jobs", 0, [](const SpeedMeasures& run) { return run.jobs.count; });
  add("mean mapping job, ms", 1, [](const SpeedMeasures& run) { return run.jobs.mean_ms; });
  add("longest mapping job, ms", 1, [](const SpeedMeasures& run) { return run.jobs.max_ms; });
  return table.text();
}

Json times_json(const TimeSummary& times) {
  return {{"count", times.count},   {"mean_ms", times.mean_ms}, {"p50_ms", times.p50_ms},
          {"p95_ms", times.p95_ms}, {"p99_ms", times.p99_ms},   {"max_ms", times.max_ms}};
}

template <typename Value>
Json json_of(const std::optional<Value>& value) {
  return value ? Json(*value) : Json();
}

Json run_json(const SpeedMeasures& run) {
  Json json = {{"frames", run.frames}, {"with_pose", run.with_pose}, {"keyframes", run.keyframes}};
  json["frames_late"] = run.late;
  json["frames_without_online_points"] = run.without_online_points;
  json["frames_with_left_image_alone"] = run.with_left_alone;
  for (std::size_t i = 0; i < frame_stages().size(); ++i) {
    json["stages"][frame_stages()[i].key] = times_json(run.stages[i]);
  }
  json["mapping_jobs"] = times_json(run.jobs);
  json["first_pose_s"] = json_of(run.first_pose_seconds);
  json["wall_s"] = run.wall_seconds;
  json["cpu_s"] = run.cpu_seconds;
  json["instructions"] = json_of(run.instructions);
  json["peak_memory_mb"] = json_of(run.peak_memory_mb);
  return json;
}

}  // namespace

std::string speed_markdown(const SpeedCase& what, std::vector<SpeedMeasures> runs) {
  std::string text = "# Speed of " + what.recording.string() + "\n\n";
  if (runs.empty()) return printable_lines(text) + "No measurements.\n";
  std::ranges::sort(runs, {}, mean_frame_ms);
  const SpeedMeasures& median = runs[(runs.size() - 1) / 2];
  text += fmt::format("{} frames, {} with a pose; {}; pace {}; {} cores", median.frames, median.with_pose,
                      what.map ? ("on the map " + what.map->string()).c_str() : "without a map",
                      std::string(name_of(what.method.pace)), what.cores);
  if (runs.size() > 1) {
    text += fmt::format(". Run with the median frame time of {} runs, with the range of all runs", runs.size());
  }
  text += ".\n\n" + stage_table(runs, median) + "\n" + cost_table(what, runs, median);
  if (!median.instructions) text += "\nInstruction counts are not available on this machine.\n";
  return printable_lines(text);
}

std::string speed_json(const SpeedCase& what, const std::vector<SpeedMeasures>& runs) {
  Json json = {{"recording", what.recording.string()},
               {"map", what.map ? Json(what.map->string()) : Json()},
               {"pace", name_of(what.method.pace)},
               {"cores", what.cores},
               {"runs", Json::array()}};
  for (const SpeedMeasures& run : runs) json["runs"].push_back(run_json(run));
  return dump_json(json, 2) + "\n";
}

}  // namespace byre
