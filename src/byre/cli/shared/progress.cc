#include "byre/cli/shared/progress.h"

#include "byre/base/enum_names.h"
#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/base/report_row.h"
#include "byre/base/stopwatch.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <ostream>

#include <fmt/core.h>
#include <unistd.h>

namespace byre::cli {
namespace {

constexpr std::array kSignals = {SIGINT, SIGTERM, SIGHUP};
constexpr int kSignalled = 128;  // added to a signal's number, as shells do

std::atomic<int> noted_signal = 0;  // 0: none
static_assert(std::atomic<int>::is_always_lock_free, "else a signal handler may not write it");

// Async-signal-safe.
extern "C" void note_signal(int signal) {
  int none = 0;
  if (noted_signal.compare_exchange_strong(none, signal) || signal == SIGHUP) return;
  remove_unpublished_files();
  _exit(kSignalled + signal);
}

constexpr double kBarInterval_s = 0.1;
constexpr double kLineInterval_s = 10.0;
constexpr int kLineShares = 10;
constexpr int kBarWidth = 24;  // characters

std::string bar(int done, int total) {
  if (total == 0) return "";
  const auto filled = static_cast<std::size_t>(static_cast<std::int64_t>(kBarWidth) * done / total);
  return "[" + std::string(kBarWidth, '.').replace(0, filled, filled, '#') + "] ";
}

std::string_view colour_of(Tone tone) {
  return name_among<Tone::bad>({"", "\x1b[32m", "\x1b[33m", "\x1b[31m"}, tone);
}

std::string coloured(std::string_view state, Tone tone) {
  if (tone == Tone::plain) return std::string(state);
  return std::string(colour_of(tone)) + std::string(state) + "\x1b[0m";
}

bool has_colours() {
  const char* const no_color = std::getenv("NO_COLOR");
  const char* const terminal = std::getenv("TERM");
  return (no_color == nullptr || *no_color == '\0') && terminal != nullptr && std::string_view(terminal) != "dumb";
}

std::string describe_progress(int done, int total, const std::string& unit, double elapsed_s, std::string_view state) {
  std::string text = total == 0 ? fmt::format("{} {}", done, unit) : fmt::format("{} of {} {}", done, total, unit);
  if (elapsed_s > 0.0) {
    const double rate = done / elapsed_s;
    text += fmt::format(", {:.1f} {}/s", rate, unit);
    if (total > 0) text += fmt::format(", {} left", format_duration((total - done) / rate));
  }
  return text + ", " + std::string(state);
}

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

void show_warnings(std::ostream& stream, const std::vector<std::string>& warnings) {
  constexpr std::size_t kShown = 20;
  for (std::size_t i = 0; i < std::min(warnings.size(), kShown); ++i) {
    stream << "byre: warning: " << printable(warnings[i]) << "\n";
  }
  if (warnings.size() > kShown) stream << "byre: warning: " << warnings.size() - kShown << " more of this kind\n";
}

InterruptCatcher::InterruptCatcher() {
  noted_signal = 0;
  struct sigaction noted {};
  noted.sa_handler = note_signal;
  noted.sa_flags = SA_RESTART;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    sigaction(kSignals[i], nullptr, &previous_[i]);
    if (previous_[i].sa_handler != SIG_IGN) sigaction(kSignals[i], &noted, nullptr);
  }
}

InterruptCatcher::~InterruptCatcher() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previous_[i], nullptr);
}

bool InterruptCatcher::caught() const {
  return noted_signal != 0;
}

int exit_code_of_interrupt() {
  return kSignalled + (noted_signal == 0 ? SIGINT : noted_signal.load());
}

void ignore_write_signals() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
}

ProgressStyle progress_style(bool quiet) {
  if (quiet) return ProgressStyle::none;
  if (isatty(STDERR_FILENO) == 0) return ProgressStyle::lines;
  return has_colours() ? ProgressStyle::coloured_bar : ProgressStyle::bar;
}

bool Progress::is_due(int done, double elapsed_s) const {
  if (style_ == ProgressStyle::none) return false;
  if (shown_done_ == 0 || done == total_) return true;
  const double since_shown_s = elapsed_s - shown_elapsed_s_;
  if (style_ != ProgressStyle::lines) return since_shown_s >= kBarInterval_s;
  const auto share = [this](int frames) { return static_cast<std::int64_t>(kLineShares) * frames / total_; };
  return (total_ > 0 && share(done) > share(shown_done_)) || since_shown_s >= kLineInterval_s;
}

void Progress::update(int done, double elapsed_s, std::string_view state, Tone tone) {
  if (!is_due(done, elapsed_s)) return;
  const std::string shown_state = style_ == ProgressStyle::coloured_bar ? coloured(state, tone) : std::string(state);
  const std::string text = describe_progress(done, total_, unit_, elapsed_s, shown_state);
  if (style_ != ProgressStyle::lines) {
    constexpr const char* kCutAtEdge = "\x1b[?7l";
    constexpr const char* kWrapAtEdge = "\x1b[?7h";
    constexpr const char* kClearToEnd = "\x1b[K";
    stream_ << kCutAtEdge << "\r" << bar(done, total_) << text << kClearToEnd << kWrapAtEdge << std::flush;
  } else {
    stream_ << text << std::endl;
  }
  shown_done_ = done;
  shown_elapsed_s_ = elapsed_s;
}

void Progress::close() {
  if (style_ != ProgressStyle::lines && shown_done_ > 0) stream_ << std::endl;
  shown_done_ = 0;
}

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
