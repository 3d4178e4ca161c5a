#pragma once

#include "byre/playback/frame_source.h"
#include "byre/playback/play.h"

#include <array>
#include <csignal>
#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre::cli {

// One per line; of a large number only the first, and the number of the rest.
void show_warnings(std::ostream& stream, const std::vector<std::string>& warnings);

// Records the first SIGINT (Ctrl-C), SIGTERM or SIGHUP (terminal closed) during its lifetime. A second signal removes
// temporary files, so that outputs are unchanged, and ends the program with exit code 128 plus the signal's number.
// SIGHUP never ends the program, because a closing terminal sends several. Ignored signals stay ignored, as with nohup.
// At most one instance may exist.
class InterruptCatcher {
 public:
  InterruptCatcher();
  ~InterruptCatcher();
  InterruptCatcher(const InterruptCatcher&) = delete;
  InterruptCatcher& operator=(const InterruptCatcher&) = delete;

  bool caught() const;

 private:
  std::array<struct sigaction, 3> previous_{};  // constant after construction
};

// Exit code for the signal that the last catcher recorded.
int exit_code_of_interrupt();

// From now on, writing to a closed pipe or beyond the file size limit fails, instead of ending the program before its
// other outputs are written.
void ignore_write_signals();

//   bar           a line that is redrawn: for a terminal
//   coloured_bar  a bar with a coloured state
//   lines         a line per tenth of the work or ten seconds: for a log
enum class ProgressStyle : std::uint8_t { none, bar, coloured_bar, lines };

// Rating of a state: green, yellow and red on a terminal.
enum class Tone : std::uint8_t { plain, good, doubtful, bad };

// Style for stderr. No colours with NO_COLOR (no-color.org), or on a terminal without colours.
ProgressStyle progress_style(bool quiet);

// Displays progress, rate and remaining time.
class Progress {
 public:
  // total: zero if unknown. unit: counted items, in the plural. The stream must outlive it.
  Progress(std::ostream& stream, ProgressStyle style, int total, std::string unit = "frames")
      : stream_(stream), style_(style), total_(total), unit_(std::move(unit)) {}

  // Call after each item: number done, elapsed seconds, and state of the last item.
  void update(int done, double elapsed_s, std::string_view state, Tone tone = Tone::plain);

  // Keeps the last bar visible; call it before other output.
  void close();

 private:
  bool is_due(int done, double elapsed_s) const;

  std::ostream& stream_;
  const ProgressStyle style_;
  const int total_;
  const std::string unit_;
  int shown_done_ = 0;
  double shown_elapsed_s_ = 0.0;
};

// Hooks that print finishing steps to stderr unless quiet, and stop at Ctrl-C. The catcher must outlive them.
FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet);

// play() with progress on stderr unless quiet; stopped by Ctrl-C. Calls after_frame, on_frame and on_map_update of
// more_hooks unless empty; the other hooks are set here.
RunResult play_with_progress(Slam& slam, Recording& recording, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet);
RunResult play_with_progress(Slam& slam, FrameSource& frames, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
