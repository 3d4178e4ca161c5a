#include "byre/cli/shared/run_with_progress.h"

#include "byre/base/stopwatch.h"
#include "byre/cli/shared/progress.h"

#include <iostream>
#include <utility>

#include <fmt/core.h>

namespace byre::cli {
namespace {

std::string state_after(const PlayedFrame& frame, bool is_mission) {
  if (!frame.report) return "unreadable frame";
  std::string state(to_string(frame.report->state));
  if (is_mission) state += ", " + std::string(to_string(frame.report->health.verdict));
  return state + fmt::format(", {} keyframes, {} points, {:.0f} MB", frame.keyframes, frame.points, frame.memory_mb);
}

Tone tone_after(const PlayedFrame& frame, bool is_mission) {
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
RunResult play_source(Slam& slam, Source& source, int frames, const PlayHooks& more_hooks,
                      const InterruptCatcher& interrupt, bool quiet) {
  Progress progress(std::cerr, progress_style(quiet), frames);
  const Stopwatch watch;
  const FinishHooks finishing = finish_hooks(interrupt, quiet);
  const bool is_mission = slam.impl().inputs().offline != nullptr;
  PlayHooks hooks = more_hooks;
  hooks.should_stop = finishing.should_stop;
  hooks.after_frame = [&](int done, const PlayedFrame& frame) {
    if (more_hooks.after_frame) more_hooks.after_frame(done, frame);
    progress.update(done, watch.seconds(), state_after(frame, is_mission), tone_after(frame, is_mission));
  };
  hooks.before_finishing_step = [&progress, &finishing](const char* step) {
    progress.close();
    if (finishing.before_step) finishing.before_step(step);
  };
  RunResult run = play(slam, source, hooks);
  progress.close();
  return run;
}

}  // namespace

RunResult play_with_progress(Slam& slam, Recording& recording, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet) {
  return play_source(slam, recording, recording.size(), more_hooks, interrupt, quiet);
}

RunResult play_with_progress(Slam& slam, FrameSource& frames, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet) {
  return play_source(slam, frames, 0, more_hooks, interrupt, quiet);
}

}  // namespace byre::cli
