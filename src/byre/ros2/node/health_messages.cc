#include "byre/ros2/node/health_messages.h"

#include "byre/playback/report/report_json.h"
#include "byre/playback/report/ros_report.h"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
std::string advice_for(DistrustReason doubt) {
  switch (doubt) {
    case DistrustReason::no_pose:
      return "move the robot into the mapped area";
    case DistrustReason::blinded:
      return "check for covered lenses, darkness and glare";
    case DistrustReason::frozen:
      return "restart the camera's driver";
    case DistrustReason::right_camera:
      return "check lens and exposure of the right camera";
    case DistrustReason::cameras_disagree:
      return "check whether the cameras are synchronised, swapped or displaced; calibrate them";
    case DistrustReason::calibration:
      return "calibrate the cameras";
    case DistrustReason::map_damaged:
      return "replace the map by a copy, then send load NAME or restart the node";
    case DistrustReason::bridged:
      return "check for covered lenses and darkness; dead reckoning by wheels is usable for some metres only";
    case DistrustReason::off_the_plane:
    case DistrustReason::in_wall:
    case DistrustReason::outside:
    case DistrustReason::behind_wall:
      return "set the initial pose, move the robot to a distinctive place, or check the floor plan";
    default:
      return "";
  }
}

ros::DiagnosticStatus localisation_status(const FrameReport& report) {
  const Health& health = report.health;
  ros::DiagnosticStatus status;
  status.level = diagnostic_level(health.verdict);
  status.name = "byre: localisation";
  const std::string advice = advice_for(health.doubt);
  status.message = verdict_and_doubt(health);
  if (!advice.empty()) status.message += "; " + advice;
  if (const std::string dirt = note_on_dirt(health); !dirt.empty()) {
    status.level = std::max(status.level, ros::DiagnosticStatus::kWarn);
    status.message += "; " + dirt;
  }
  status.values = {{"verdict", std::string(to_string(health.verdict))},
                   {"doubt", std::string(to_string(health.doubt))},
                   {"state", std::string(to_string(report.state))},
                   {"offline inliers", std::to_string(health.offline_inliers)},
                   {"offline points expected", std::to_string(health.offline_expected)},
                   {"online inliers", std::to_string(health.online_inliers)},
                   {"position sigma, m", fmt::format("{:.4f}", health.position_sigma)},
                   {"rotation sigma, rad", fmt::format("{:.5f}", health.rotation_sigma)},
                   {"distance since offline points, m", fmt::format("{:.2f}", health.distance_since_offline)}};
  return status;
}

void log_changes(const FrameReport& report, const std::optional<FrameReport>& last,
                 const std::optional<std::string>& map_damage,
                 const std::function<std::string(MotionSensor sensor)>& source_of, const NodeLog& log) {
  const Health& health = report.health;
  for (const SessionEvent event : report.events) {
    if (event == SessionEvent::dirt_found) {
      log(LogLevel::warning, note_on_dirt(health));
      continue;
    }
    log(event == SessionEvent::navigation_error ? LogLevel::error : LogLevel::info, std::string(to_string(event)));
  }
  const bool was_damaged = last && last->health.doubt == DistrustReason::map_damaged;
  if (health.doubt == DistrustReason::map_damaged && !was_damaged) {
    log(LogLevel::error, map_damage.value_or("the map file is damaged"));
  }
  for (const MotionWarning& warning : report.warnings) {
    log(LogLevel::warning, to_text(warning, source_of(warning.sensor)));
  }
  if (last && last->health.verdict == health.verdict) return;
  log(health.verdict == Verdict::untrusted ? LogLevel::warning : LogLevel::notice, verdict_and_doubt(health));
}

std::string health_line(const FrameReport& report) {
  nlohmann::ordered_json line = {{"time_ns", report.time.count()}, {"state", to_string(report.state)}};
  line["pose"] = report.map_from_body ? pose_json(*report.map_from_body, report.covariance) : nlohmann::ordered_json();
  line["health"] = health_json(report.health);
  return dump_json(line);
}

}  // namespace byre
