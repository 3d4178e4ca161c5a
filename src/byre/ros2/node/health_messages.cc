#include "byre/ros2/node/health_messages.h"

#include "byre/playback/report/report.h"
#include "byre/playback/report/ros_report.h"

#include <algorithm>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

std::string metric(const char* name, const char* type, const char* help, double value) {
  return fmt::format("# HELP {} {}\n# TYPE {} {}\n{} {:.9g}\n", name, help, name, type, name, value);
}

}  // namespace

ros::DiagnosticStatus localisation_status(const FrameReport& report) {
  const Health& health = report.health;
  ros::DiagnosticStatus status;
  status.level = diagnostic_level(health.verdict);
  status.name = "byre: localisation";
  const std::string advice(advice_for(health.doubt));
  status.message = verdict_and_doubt(health);
  if (!advice.empty()) status.message += "; " + advice;
  if (const std::string dirt = note_on_dirt(health); !dirt.empty()) {
    status.level = std::max(status.level, ros::DiagnosticStatus::kWarn);
    status.message += "; " + dirt;
  }
  status.values = health_values(report);
  return status;
}

ros::DiagnosticStatus registry_status(const RobotLinkState& state, std::chrono::system_clock::time_point now) {
  ros::DiagnosticStatus status;
  status.name = "byre: registry";
  const auto add = [&status](std::byte level, const std::string& text) {
    status.level = std::max(status.level, level);
    status.message += (status.message.empty() ? "" : "; ") + text;
  };
  if (!state.fault.empty()) add(ros::DiagnosticStatus::kWarn, state.fault);
  if (!state.refused.empty()) {
    add(ros::DiagnosticStatus::kWarn, "version " + state.refused + " is refused: " + state.reason);
  } else if (!state.fetched.empty()) {
    add(ros::DiagnosticStatus::kOk, "version " + state.fetched + " waits for the command update");
  }
  if (state.left_out > 0) {
    add(ros::DiagnosticStatus::kWarn,
        fmt::format("{} sessions were not stored, as those that wait exceed registry.max_megabytes", state.left_out));
  }
  if (status.message.empty()) status.message = state.contact ? "in contact" : "not contacted yet";
  const auto seconds_ago = [now](std::chrono::system_clock::time_point time) {
    return fmt::format("{} s ago", std::chrono::duration_cast<std::chrono::seconds>(now - time).count());
  };
  status.values = {{"version in use", state.present},
                   {"accepted version", state.accepted},
                   {"fetched version", state.fetched},
                   {"refused version", state.refused},
                   {"sessions waiting", std::to_string(state.waiting)},
                   {"megabytes waiting", fmt::format("{:.1f}", 1e-6 * static_cast<double>(state.waiting_bytes))},
                   {"sessions not stored", std::to_string(state.left_out)},
                   {"last contact", state.contact ? seconds_ago(*state.contact) : "never"}};
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
    if (event == SessionEvent::map_changed) {
      log(LogLevel::notice, "map changed to " + report.map);
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
  if (!report.map.empty()) line["map"] = report.map;
  line["pose"] = report.map_from_body ? pose_json(*report.map_from_body, report.covariance) : nlohmann::ordered_json();
  line["health"] = health_json(report.health);
  return dump_json(line);
}

std::string metrics_text(const NodeCounters& counters) {
  std::string text = metric("byre_images_total", "counter", "Received left images", counters.images) +
                     metric("byre_images_left_out_total", "counter",
                            "Left images replaced by newer ones before tracking", counters.skipped) +
                     metric("byre_frames_total", "counter", "Frames passed to tracking", counters.frames);
  if (!counters.last) return text;
  const FrameReport& report = *counters.last;
  const Health& health = report.health;
  text += metric("byre_verdict", "gauge", "0 trusted, 1 degraded, 2 untrusted", static_cast<int>(health.verdict));
  text += metric("byre_has_pose", "gauge", "1: the pose in the map is available", report.map_from_body ? 1 : 0);
  text += metric("byre_track_seconds", "gauge", "Tracking time of the last frame", report.track_seconds);
  text += metric("byre_frame_late", "gauge", "1: the last frame exceeded its deadline", report.is_late);
  text += metric("byre_online_points_left_out", "gauge",
                 "1: online points were limited in the last frame to meet the deadline", report.cuts.online_points);
  text += metric("byre_right_image_left_out", "gauge", "1: the last frame was tracked with its left image only",
                 report.cuts.right_image);
  text += metric("byre_offline_inliers", "gauge", "Inliers of the offline map", health.offline_inliers);
  text += metric("byre_online_inliers", "gauge", "Inliers of the online map", health.online_inliers);
  text += metric("byre_position_sigma_metres", "gauge", "Standard error of the position", health.position_sigma);
  return text;
}

}  // namespace byre
