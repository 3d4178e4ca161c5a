#include "byre/playback/archive/scale_by_distance.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/map/scaled_copy.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/core.h>

namespace byre {
namespace {

std::optional<std::string_view> after(std::string_view prefix, std::string_view text) {
  return text.starts_with(prefix) ? std::optional(text.substr(prefix.size())) : std::nullopt;
}

[[noreturn]] void reject(const std::string& text, const std::string& reason) {
  throw InputError("--between " + text, reason, "give x,y,z, or point:NUMBER, or time:SECONDS");
}

Eigen::Vector3d point_position(const StoredMap& stored, const std::string& text, std::string_view number) {
  const auto parsed = parse_whole<std::uint32_t>(number);
  if (!parsed) reject(text, "is not a point number");
  const MapPoint* const point = stored.map.find_point({Origin::offline, *parsed});
  if (point == nullptr) reject(text, "is not in the map");
  return point->position_in_world;
}

std::string time_span(const MapGraph& map) {
  if (map.keyframe_count() == 0) return "which has none";
  Timestamp first = Timestamp::max(), last = Timestamp::min();
  for (const KeyframeId id : map.keyframe_ids()) {
    first = std::min(first, map.find_keyframe(id)->frame.time);
    last = std::max(last, map.find_keyframe(id)->frame.time);
  }
  return fmt::format("which cover {:.3f} to {:.3f} s", to_seconds(first), to_seconds(last));
}

Eigen::Vector3d camera_position_at(const StoredMap& stored, const std::string& text, std::string_view seconds) {
  constexpr double kMaxGap = 1.0;  // seconds
  const auto parsed = parse_whole<double>(seconds);
  if (!parsed) reject(text, "is not a time");
  const Keyframe* nearest = nullptr;
  double nearest_gap = kMaxGap;
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe* const keyframe = stored.map.find_keyframe(id);
    const double gap = std::abs(to_seconds(keyframe->frame.time) - *parsed);
    if (gap > nearest_gap) continue;
    nearest_gap = gap;
    nearest = keyframe;
  }
  if (nearest == nullptr)
    reject(text, "is more than a second from every keyframe of the map, " + time_span(stored.map));
  return inverse(nearest->camera_from_world).translation;
}

Eigen::Vector3d position(const std::string& text) {
  std::vector<double> numbers;
  std::string_view rest = text;
  while (true) {
    const std::size_t comma = std::min(rest.find(','), rest.size());
    const auto number = parse_whole<double>(rest.substr(0, comma));
    if (!number || !std::isfinite(*number)) reject(text, "is not a place");
    numbers.push_back(*number);
    if (comma == rest.size()) break;
    rest.remove_prefix(comma + 1);
  }
  if (numbers.size() != 3) reject(text, "does not have three coordinates");
  return {numbers[0], numbers[1], numbers[2]};
}

}  // namespace

Eigen::Vector3d find_place(const StoredMap& stored, const std::string& text) {
  if (const auto number = after("point:", text)) return point_position(stored, text, *number);
  if (const auto seconds = after("time:", text)) return camera_position_at(stored, text, *seconds);
  return position(text);
}

ScaledMap scale_by_distance(const StoredMap& stored, const std::string& first, const std::string& second,
                            double metres) {
  if (std::ranges::any_of(stored.map.rigs(), &Rig::is_stereo)) {
    throw InputError("the map", "was made by a stereo or depth camera and is already metric", "use it unchanged");
  }
  ScaledMap scaled;
  scaled.distance = (find_place(stored, first) - find_place(stored, second)).norm();
  if (!(scaled.distance > 0.0)) {
    throw InputError("--between " + first + " " + second, "is the same place twice", "give two different places");
  }
  scaled.factor = metres / scaled.distance;
  scaled.stored = scaled_copy(stored, scaled.factor);
  scaled.stored.scale = MapScale::metric;
  return scaled;
}

}  // namespace byre
