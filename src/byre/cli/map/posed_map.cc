#include "byre/cli/map/posed_map.h"

#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"
#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/warnings.h"
#include "byre/features/image_threads.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/map_from_poses_run.h"
#include "byre/playback/report/run_report.h"
#include "byre/playback/source_recording.h"
#include "byre/slam/system/stored_map.h"

#include <iostream>
#include <memory>

#include <fmt/core.h>

namespace byre::cli {
namespace {

PosedRun run_with_progress(Recording& recording, const MapOptions& options, const InterruptCatcher& interrupt) {
  Progress progress(std::cerr, progress_style(options.quiet), recording.size());
  const Stopwatch watch;
  PosedRunOptions run_options;
  run_options.extract = options.method.options().extract;
  PosedRunHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&](int done) { progress.update(done, watch.seconds(), "poses given"); };
  PosedRun run = run_map_from_poses(recording, load_truth(*options.given_poses), run_options, hooks);
  progress.close();
  return run;
}

std::string to_text(const PosedRun& run, const MapOptions& options) {
  std::string poses = "given by " + options.given_poses->string() + ", not estimated";
  if (run.without_pose > 0) poses += fmt::format("; {} frames without pose are skipped", run.without_pose);
  return row("recording", fmt::format("{}, {} frames", options.recording.string(), run.frames)) + row("poses", poses) +
         row("map", fmt::format("{} keyframes, {} points", run.map.keyframe_count(), run.map.point_count())) +
         row("written", options.map->string());
}

}  // namespace

ExitCode run_posed_map(const MapOptions& options, std::ostream& result) {
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  const std::unique_ptr<Recording> recording = open_recording(options.recording, options.range, options.open);
  if (!options.quiet) show_warnings(std::cerr, recording->warnings());
  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const PosedRun run = run_with_progress(*recording, options, interrupt);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);

  StoredMap stored;
  stored.map = run.map;
  stored.recordings = {{source_name(options.recording),
                        recording->calibration(),
                        recording->times().front(),
                        recording->times().back(),
                        {}}};
  stored.pose_source = PoseSource::given;
  save_for_missions(std::move(stored), vocabulary, options.site, *options.map);
  result << to_text(run, options);
  if (interrupt.caught()) return ExitCode::interrupted;
  require_frames(run.unreadable, run.frames, run.warnings);
  return ExitCode::done;
}

}  // namespace byre::cli
