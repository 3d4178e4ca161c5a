#include "byre/io/recording/recording_options.h"

#include <array>
#include <charconv>

namespace byre {
namespace {

constexpr std::array kChoices = {CameraChoice::stereo, CameraChoice::left, CameraChoice::right, CameraChoice::rgbd};

std::optional<int> parse_index(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

}  // namespace

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

std::optional<CameraChoice> parse_camera(std::string_view text) {
  for (const CameraChoice choice : kChoices) {
    if (text == to_string(choice)) return choice;
  }
  return std::nullopt;
}

}  // namespace byre
