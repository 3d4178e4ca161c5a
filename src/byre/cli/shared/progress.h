#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>

namespace byre::cli {

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

}  // namespace byre::cli
