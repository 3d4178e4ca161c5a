#include "byre/cli/frame_range_options.h"

#include "byre/cli/number_check.h"
#include <charconv>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

constexpr double kLongest_s = 1e9;

std::optional<int> parse_index(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace

void declare_frame_range(CLI::App& command, FrameRange& range) {
  command.add_option("--start", range.start_s, "Begin so long after the recording's first frame")
      ->type_name("SECONDS")
      ->check(between(0.0, kLongest_s));
  command.add_option("--end", range.end_s, "End before so long after the recording's first frame")
      ->type_name("SECONDS")
      ->check(between(0.0, kLongest_s));
  const auto set_frames = [&range](const std::string& text) {
    const std::optional<FrameRange> frames = parse_frames(text);
    if (!frames) throw CLI::ValidationError("--frames", "\"" + text + "\" is no range of frames such as 0:150");
    range.first = frames->first;
    range.last = frames->last;
  };
  command
      .add_option_function<std::string>(
          "--frames", set_frames, "Frames of the recording, counted from 0, END exclusive; either may be left out")
      ->type_name("FIRST:END");
  command.add_option("--stride", range.stride, "Take every n-th frame of those")
      ->type_name("N")
      ->check(between(1, 1'000'000))
      ->capture_default_str();
}

void require_sense(const FrameRange& range) {
  if (range.start_s && range.end_s && *range.start_s >= *range.end_s) {
    throw CLI::ValidationError("--start", "must be less than --end");
  }
}

std::optional<FrameRange> parse_frames(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view first = text.substr(0, colon), end = text.substr(colon + 1);
  FrameRange range;
  if (!first.empty()) {
    const std::optional<int> index = parse_index(first);
    if (!index) return std::nullopt;
    range.first = *index;
  }
  if (end.empty()) return range;
  range.last = parse_index(end);
  if (!range.last || *range.last <= range.first) return std::nullopt;
  return range;
}

}  // namespace byre::cli
