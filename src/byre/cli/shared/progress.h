#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>

namespace byre::cli {

//   bar           one line, drawn again and again: for a terminal
//   coloured_bar  the same, with the state in a colour by how good it is
//   lines         a line every tenth of the work or ten seconds: for a log
enum class ProgressStyle : std::uint8_t { none, bar, coloured_bar, lines };

// How good a state is, where that can be said: on a terminal green, yellow and red.
enum class Tone : std::uint8_t { plain, good, doubtful, bad };

// What suits the standard error stream. Without colours where NO_COLOR is set (no-color.org) or the terminal has none.
ProgressStyle progress_style(bool quiet);

// Tells how far the frames, or other things, are, how fast they go, and for how long they still will.
class Progress {
 public:
  // total: zero where nobody knows how many there will be. unit: what is counted, in the plural. The stream must
  // outlive it.
  Progress(std::ostream& stream, ProgressStyle style, int total, std::string unit = "frames")
      : stream_(stream), style_(style), total_(total), unit_(std::move(unit)) {}

  // After each one: how many are done, in how many seconds, and what state the last one left.
  void update(int done, double elapsed_s, std::string_view state, Tone tone = Tone::plain);

  // Leaves the bar standing; call it before anything else is printed.
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

}  // namespace byre::cli
