#include "byre/benchmark/speed.h"

#include "byre/base/printable.h"
#include "byre/base/stopwatch.h"
#include "byre/benchmark/markdown_table.h"
#include "byre/playback/report/report.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/resources.h"

#include <algorithm>
#include <array>
#include <fstream>
#include <utility>

#include <fmt/core.h>
#include <linux/perf_event.h>
#include <malloc.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace byre {
namespace {

constexpr auto kStages = std::to_array<FrameStage>({
    {"decode, ahead", "decode", &StageSeconds::decode},
    {"rectify", "rectify", &StageSeconds::rectify},
    {"extract", "extract", &StageSeconds::extract},
    {"stereo", "stereo", &StageSeconds::stereo},
    {"track", "track", &StageSeconds::track},
    {"map", "map", &StageSeconds::map},
    {"frame", "frame", &StageSeconds::total},
});

SpeedMeasures measures_of(const RunResult& run) {
  SpeedMeasures measures;
  const FrameCounts counts = count_frames(run.frames);
  measures.frames = counts.frames - counts.unreadable;
  measures.with_pose = counts.with_pose;
  measures.keyframes = counts.keyframes;
  measures.late = counts.late;
  measures.without_online_points = counts.without_online_points;
  measures.with_left_alone = counts.with_left_alone;
  for (const FrameStage& stage : kStages) measures.stages.push_back(summarise_stage(run.frames, stage.seconds));
  measures.jobs = summarise_times(run.job_seconds);
  return measures;
}

using Json = nlohmann::ordered_json;

double mean_frame_ms(const SpeedMeasures& run) {
  return run.stages.back().mean;
}

Json time_json(const Distribution& times) {
  return {{"count", times.count}, {"mean_ms", times.mean}, {"p50_ms", times.p50},
          {"p95_ms", times.p95},  {"p99_ms", times.p99},   {"max_ms", times.max}};
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

bool reset_peak_memory() {
  malloc_trim(0);
  std::ofstream file("/proc/self/clear_refs");
  file << "5" << std::flush;  // resets the peak, see proc(5)
  return file.good();
}

std::optional<double> peak_memory_mb() {
  constexpr double kMegabytesPerKibibyte = 1024.0 / 1e6;
  std::ifstream file("/proc/self/status");
  for (std::string word; file >> word;) {
    double kibibytes = 0.0;
    if (word == "VmHWM:" && file >> kibibytes) return kMegabytesPerKibibyte * kibibytes;
  }
  return std::nullopt;
}

InstructionCounter::InstructionCounter() {
  perf_event_attr attributes{};
  attributes.size = sizeof attributes;
  attributes.type = PERF_TYPE_HARDWARE;
  attributes.config = PERF_COUNT_HW_INSTRUCTIONS;
  attributes.inherit = 1;
  attributes.exclude_kernel = 1;
  attributes.exclude_hv = 1;
  constexpr int kThisThread = 0, kAnyProcessor = -1, kNoGroup = -1;
  descriptor_ = static_cast<int>(
      syscall(SYS_perf_event_open, &attributes, kThisThread, kAnyProcessor, kNoGroup, PERF_FLAG_FD_CLOEXEC));
}

InstructionCounter::~InstructionCounter() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::optional<std::uint64_t> InstructionCounter::count() const {
  std::uint64_t instructions = 0;
  if (descriptor_ < 0 || read(descriptor_, &instructions, sizeof instructions) != sizeof instructions)
    return std::nullopt;
  return instructions;
}

std::span<const FrameStage> frame_stages() {
  return kStages;
}

SpeedMeasures measure_speed(const SpeedCase& what, const PlayHooks& hooks) {
  const bool is_reset = reset_peak_memory();
  const double cpu_before = resource_usage().cpu_seconds;
  const InstructionCounter instructions;
  const Stopwatch watch;

  const ScaledRecording opened = open_scaled(what.recording, what.range, what.open, what.map.has_value());
  SlamOptions options = slam_options(what.method);
  options.vocabulary = what.vocabulary;
  options.baseline = what.open.baseline;
  const Calibration& calibration = opened.recording->calibration();
  Slam slam = what.map ? Slam::on_map(calibration, *what.map, options) : Slam::mapping(calibration, options);
  std::optional<double> first_pose_seconds;
  PlayHooks watched = hooks;
  watched.after_frame = [&](int done, const PlayedFrame& frame) {
    const bool has_pose = frame.report && frame.report->map_from_body;
    if (has_pose && !first_pose_seconds) first_pose_seconds = watch.seconds();
    hooks.after_frame(done, frame);
  };
  const RunResult run = play(slam, *opened.recording, watched);
  if (run.map_damage) throw InputError(*run.map_damage);

  SpeedMeasures measures = measures_of(run);
  measures.first_pose_seconds = first_pose_seconds;
  measures.wall_seconds = watch.seconds();
  measures.cpu_seconds = resource_usage().cpu_seconds - cpu_before;
  measures.instructions = instructions.count();
  if (is_reset) measures.peak_memory_mb = peak_memory_mb();
  return measures;
}

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
