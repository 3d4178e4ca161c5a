#include "byre/cli/shared/progress.h"

#include "byre/base/report_row.h"

#include <cmath>
#include <cstdlib>
#include <ostream>

#include <unistd.h>

#include <fmt/core.h>

namespace byre::cli {
namespace {

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
  switch (tone) {
    case Tone::plain:
      return "";
    case Tone::good:
      return "\x1b[32m";
    case Tone::doubtful:
      return "\x1b[33m";
    case Tone::bad:
      return "\x1b[31m";
  }
  return "";
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

}  // namespace

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

}  // namespace byre::cli
