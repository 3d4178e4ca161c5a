#include "byre/playback/report/event_log.h"

#include "byre/playback/report/report.h"

#include <ostream>
#include <string_view>

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

// Fields of every line.
Json line_of(int number, const FrameReport& report, std::string_view event) {
  Json line = {{"time_s", to_seconds(report.time)},
               {"time_ns", report.time.count()},
               {"frame", number},
               {"event", event},
               {"state", to_string(report.state)},
               {"verdict", to_string(report.health.verdict)},
               {"doubt", to_string(report.health.doubt)},
               {"position_m", position_json(report.map_from_body)},
               {"distance_since_offline_m", report.health.distance_since_offline},
               {"seconds_since_offline", report.health.seconds_since_offline}};
  if (!report.map.empty()) line["map"] = report.map;
  return line;
}

bool moves_the_pose(SessionEvent event) {
  switch (event) {
    case SessionEvent::localised:
    case SessionEvent::relocalised:
    case SessionEvent::online_corrected:
    case SessionEvent::map_corrected:
    case SessionEvent::recalibrated:
      return true;
    default:
      return false;
  }
}

// Distance between the map pose and its prediction by odometry alone; null if either is missing.
Json jump_json(const FrameReport& report, const std::optional<Pose>& map_from_odometry_before) {
  if (!map_from_odometry_before || !report.map_from_body || !report.odometry_from_body) return nullptr;
  const Pose expected = *map_from_odometry_before * *report.odometry_from_body;
  return (report.map_from_body->translation - expected.translation).norm();
}

template <typename Value>
Json before_json(const std::optional<Value>& before) {
  return before ? Json(to_string(*before)) : Json();
}

}  // namespace

void EventLog::note(int number, const PlayedFrame& frame) {
  if (!frame.report) return;
  const FrameReport& report = *frame.report;
  const auto write = [this](const Json& line) { stream_ << dump_json(line) << std::endl; };
  for (const SessionEvent event : report.events) {
    Json line = line_of(number, report, to_string(event));
    if (moves_the_pose(event)) line["jump_m"] = jump_json(report, map_from_odometry_);
    if (event == SessionEvent::tag_moved) {
      for (const MappedTag& tag : report.moved_tags) line["tags"].push_back(to_string(tag.id));
    }
    if (event == SessionEvent::place_refused) line["reason"] = to_string(report.refused_place);
    if (event == SessionEvent::dirt_found) line["note"] = note_on_dirt(report.health);
    if (event == SessionEvent::blinded) line["image"] = health_json(report.health).at("image");
    write(line);
  }
  if (state_ != report.state) {
    Json line = line_of(number, report, "state changed");
    line["before"] = before_json(state_);
    write(line);
  }
  if (verdict_ != report.health.verdict) {
    Json line = line_of(number, report, "verdict changed");
    line["before"] = before_json(verdict_);
    line["health"] = health_json(report.health);
    write(line);
  }
  state_ = report.state;
  verdict_ = report.health.verdict;
  if (report.map_from_body && report.odometry_from_body) {
    map_from_odometry_ = *report.map_from_body * inverse(*report.odometry_from_body);
  }
}

}  // namespace byre
