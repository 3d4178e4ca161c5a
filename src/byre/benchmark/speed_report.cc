#include "byre/base/printable.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/benchmark/speed.h"
#include "byre/playback/report/report.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

double mean_frame_ms(const SpeedMeasures& run) {
  return run.stages.back().mean_ms;
}

Json time_json(const TimeSummary& times) {
  return {{"count", times.count},   {"mean_ms", times.mean_ms}, {"p50_ms", times.p50_ms},
          {"p95_ms", times.p95_ms}, {"p99_ms", times.p99_ms},   {"max_ms", times.max_ms}};
}

Json run_json(const SpeedMeasures& run) {
  Json json = {{"frames", run.frames}, {"with_pose", run.with_pose}, {"keyframes", run.keyframes}};
  json["frames_late"] = run.late;
  json["frames_without_online_points"] = run.without_online_points;
  json["frames_with_left_image_alone"] = run.with_left_alone;
  for (std::size_t i = 0; i < frame_stages().size(); ++i) {
    json["stages"][frame_stages()[i].key] = time_json(run.stages[i]);
  }
  json["mapping_jobs"] = time_json(run.jobs);
  json["first_pose_s"] = or_null(run.first_pose_seconds);
  json["wall_s"] = run.wall_seconds;
  json["cpu_s"] = run.cpu_seconds;
  json["instructions"] = or_null(run.instructions);
  json["peak_memory_mb"] = or_null(run.peak_memory_mb);
  return json;
}

// Figure of the median run, with the range over all runs if they differ.
std::string cell_with_range(const std::vector<Json>& runs, const Json& median, const std::string& pointer, int digits) {
  const Json::json_pointer key(pointer);
  const auto shown = [digits](double value) { return fmt::format("{:.{}f}", value, digits); };
  std::vector<double> values;
  for (const Json& run : runs) {
    if (!run.at(key).is_null()) values.push_back(run.at(key).get<double>());
  }
  if (median.at(key).is_null()) return kEmptyCell;
  const std::string text = shown(median.at(key));
  const auto [least, most] = std::ranges::minmax(values);
  return shown(least) == shown(most) ? text : text + " (" + shown(least) + " to " + shown(most) + ")";
}

std::string stage_table(const std::vector<Json>& runs, const Json& median) {
  MarkdownTable table({"wall time per frame, ms", "mean", "median", "95 %", "99 %", "worst"});
  for (const FrameStage& stage : frame_stages()) {
    std::vector<std::string> cells = {stage.name};
    for (const char* const figure : {"/mean_ms", "/p50_ms", "/p95_ms", "/p99_ms", "/max_ms"}) {
      cells.push_back(cell_with_range(runs, median, std::string("/stages/") + stage.key + figure, 2));
    }
    table.add(std::move(cells));
  }
  return table.text();
}

std::string cost_table(const SpeedCase& what, const std::vector<Json>& runs, const Json& median) {
  MarkdownTable table({"the whole run", "figure"});
  const auto add = [&](const char* name, const char* pointer, int digits) {
    table.add({name, cell_with_range(runs, median, pointer, digits)});
  };
  add("time to first pose, s", "/first_pose_s", 2);
  add("CPU time, s", "/cpu_s", 2);
  add("wall time, s", "/wall_s", 2);
  add("peak memory, MB", "/peak_memory_mb", 0);
  add("instructions per frame, millions", "/mega_instructions_per_frame", 1);
  add("keyframes", "/keyframes", 0);
  if (what.method.frame_deadline_ms > 0.0) {
    add("frames late", "/frames_late", 0);
    add("frames with limited online points", "/frames_without_online_points", 0);
    add("frames without the right image", "/frames_with_left_image_alone", 0);
  }
  add("mapping jobs", "/mapping_jobs/count", 0);
  add("mean mapping job, ms", "/mapping_jobs/mean_ms", 1);
  add("longest mapping job, ms", "/mapping_jobs/max_ms", 1);
  return table.text();
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
  std::vector<Json> figures;
  for (const SpeedMeasures& run : runs) {
    Json& json = figures.emplace_back(run_json(run));
    json["mega_instructions_per_frame"] =
        run.instructions && run.frames > 0 ? Json(static_cast<double>(*run.instructions) / 1e6 / run.frames) : Json();
  }
  const Json& median_figures = figures[(figures.size() - 1) / 2];
  text += ".\n\n" + stage_table(figures, median_figures) + "\n" + cost_table(what, figures, median_figures);
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
