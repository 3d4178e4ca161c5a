#include "byre/cli/shared/run_with_progress.h"

#include "byre/base/stopwatch.h"
#include "byre/cli/shared/progress.h"

#include <iostream>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

std::string state_after(const MappedFrame& frame, bool is_mission) {
  if (!frame.report) return "unreadable frame";
  std::string state(to_string(frame.report->state));
  if (is_mission) state += ", " + std::string(to_string(frame.report->health.verdict));
  return state + fmt::format(", {} keyframes, {} points, {:.0f} MB", frame.keyframes, frame.points, frame.memory_mb);
}

Tone tone_after(const MappedFrame& frame, bool is_mission) {
  if (!frame.report) return Tone::bad;
  if (!is_mission) return Tone::plain;
  switch (frame.report->health.verdict) {
    case Verdict::trusted:
      return Tone::good;
    case Verdict::degraded:
      return Tone::doubtful;
    case Verdict::untrusted:
      return Tone::bad;
  }
  return Tone::plain;
}

}  // namespace

FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet) {
  FinishHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  if (!quiet) hooks.before_step = [](const char* step) { std::cerr << "finishing: " << step << std::endl; };
  return hooks;
}

namespace {

// frames: number expected; zero: unknown.
template <typename Source>
MapRun run_source(Source& source, int frames, const EngineOptions& options, const MapRunHooks& more_hooks,
                  const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before) {
  Progress progress(std::cerr, progress_style(quiet), frames);
  const Stopwatch watch;
  const FinishHooks finishing = finish_hooks(interrupt, quiet);
  MapRunHooks hooks;
  hooks.should_stop = finishing.should_stop;
  hooks.on_frame = more_hooks.on_frame;
  hooks.on_map_update = more_hooks.on_map_update;
  hooks.after_frame = [&](int done, const MappedFrame& frame) {
    if (more_hooks.after_frame) more_hooks.after_frame(done, frame);
    const bool is_mission = options.offline != nullptr;
    progress.update(done, watch.seconds(), state_after(frame, is_mission), tone_after(frame, is_mission));
  };
  hooks.before_finishing_step = [&progress, &finishing](const char* step) {
    progress.close();
    if (finishing.before_step) finishing.before_step(step);
  };
  MapRun run = run_map(source, options, hooks, std::move(before));
  progress.close();
  return run;
}

}  // namespace

MapRun run_with_progress(Recording& recording, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before) {
  return run_source(recording, recording.size(), options, more_hooks, interrupt, quiet, std::move(before));
}

MapRun run_with_progress(FrameSource& frames, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before) {
  return run_source(frames, 0, options, more_hooks, interrupt, quiet, std::move(before));
}

}  // namespace byre::cli
