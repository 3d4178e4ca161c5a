#include "byre/cli/commands.h"
#include "byre/cli/interrupt.h"
#include "byre/cli/map_options.h"
#include "byre/cli/map_report.h"
#include "byre/cli/output_file.h"
#include "byre/cli/posed_map.h"
#include "byre/cli/progress.h"
#include "byre/cli/stopwatch.h"
#include "byre/cli/stored_map.h"
#include "byre/cli/warnings.h"
#include "byre/evaluation/trajectory_file.h"
#include "byre/features/image_threads.h"
#include "byre/input/input_error.h"
#include "byre/map/map_file.h"

#include <algorithm>
#include <fstream>
#include <iostream>
#include <memory>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

std::unique_ptr<Recording> open_stereo_recording(const MapOptions& options) {
  std::unique_ptr<Recording> recording = open_recording(options.recording, options.range);
  if (recording->calibration().right) return recording;
  throw InputError(options.recording.string(), "has no right camera: only stereo recordings can be mapped",
                   "looked for mav0/cam1 (EuRoC) and image_1 (KITTI odometry)");
}

std::string_view state_after(const MappedFrame& frame) {
  return frame.report ? to_string(frame.report->state) : "unreadable frame";
}

MapRun run_with_progress(Recording& recording, const MapRunOptions& run_options, const InterruptCatcher& interrupt,
                         ProgressStyle style) {
  Progress progress(std::cerr, style, recording.size());
  const Stopwatch watch;
  MapRunHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&progress, &watch](int done, const MappedFrame& frame) {
    progress.update(done, watch.seconds(), state_after(frame));
  };
  MapRun run = run_map(recording, run_options, hooks);
  progress.close();
  return run;
}

void write_text(const std::string& text, const fs::path& path) {
  std::ofstream file(path);
  file << text;
  file.close();
  if (!file) throw InputError(path.string(), "cannot be written", "check that its folder exists and has space");
}

void write_results(const MapOptions& options, const MapRun& run, const MapProtocol& protocol,
                   const ResourceUse& resources) {
  if (options.trajectory) {
    write_whole(*options.trajectory, [&run](const fs::path& path) { write_trajectory(run.final, path); });
  }
  if (options.causal_trajectory) {
    write_whole(*options.causal_trajectory, [&run](const fs::path& path) { write_trajectory(run.causal, path); });
  }
  if (options.stats) {
    write_whole(*options.stats, [&](const fs::path& path) { write_text(to_json(run, protocol, resources), path); });
  }
}

std::vector<std::string> names_of(const std::vector<fs::path>& files) {
  std::vector<std::string> names;
  for (const fs::path& file : files) names.push_back(file.string());
  return names;
}

ExitCode run_map_command(MapOptions options, std::ostream& result) {
  for (const fs::path& output : options.outputs()) require_writable(output);
  if (options.given_poses) return run_posed_map(options, result);
  std::optional<Vocabulary> vocabulary;  // found to be missing now, not after an hour of mapping
  if (options.map) vocabulary = open_vocabulary(options.vocabulary);
  const std::unique_ptr<Recording> recording = open_stereo_recording(options);
  MapProtocol protocol{
      options.recording.string(), guess_format(options.recording), options.range, recording->size(), {}};
  protocol.options.pace = options.pace;
  protocol.options.extract.refinement = options.refinement;

  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const MapRun run = run_with_progress(*recording, protocol.options, interrupt, progress_style(options.quiet));
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  const ResourceUse resources = resources_used_so_far();
  write_results(options, run, protocol, resources);
  if (run.causal.empty()) options.map.reset();  // there is nothing to keep
  if (options.map) {
    StoredMap stored;
    stored.map = run.map;
    stored.recordings = {describe_source(options.recording, *recording)};
    save_for_use(std::move(stored), *vocabulary, options.site, *options.map);
  }
  result << to_text(run, protocol, resources, names_of(options.outputs()));
  if (interrupt.caught()) return ExitCode::interrupted;
  if (run.causal.empty())
    throw std::runtime_error("no frame got a pose: the images may be too dark or without texture");
  return ExitCode::done;
}

}  // namespace

Action declare_map(CLI::App& command) {
  const auto options = std::make_shared<MapOptions>();
  declare_map_options(command, *options);
  return [options](std::ostream& result) { return run_map_command(*options, result); };
}

}  // namespace byre::cli
