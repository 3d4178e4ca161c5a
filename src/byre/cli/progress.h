#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <string_view>

namespace byre::cli {

//   bar    one line, drawn again and again: for a terminal
//   lines  a line every tenth of the work or ten seconds: for a log
enum class ProgressStyle : std::uint8_t { none, bar, lines };

// Tells how far the frames are, how fast they go, and for how long they still will.
class Progress {
 public:
  // The stream must outlive it.
  Progress(std::ostream& stream, ProgressStyle style, int total_frames)
      : stream_(stream), style_(style), total_(total_frames) {}

  // After each frame: how many are done, in how many seconds, and what state the last one left.
  void update(int done, double elapsed_s, std::string_view state);

  // Leaves the bar standing; call it before anything else is printed.
  void close();

 private:
  bool is_due(int done, double elapsed_s) const;

  std::ostream& stream_;
  const ProgressStyle style_;
  const int total_;
  int shown_done_ = 0;
  double shown_elapsed_s_ = 0.0;
};

// "0:07", "12:34" or "1:02:03".
std::string format_duration(double seconds);

}  // namespace byre::cli
