#pragma once

#include "byre/frame_report.h"
#include "byre/io/ros/messages.h"
#include "byre/registry/robot_link.h"
#include "byre/ros2/node/process.h"

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace byre {

// Diagnostic of the pose: OK for trusted, WARN for degraded, ERROR for untrusted.
ros::DiagnosticStatus localisation_status(const FrameReport& report);

// Diagnostic of the registry: WARN for a fault, a refused version and sessions that are not stored. now: time of day.
ros::DiagnosticStatus registry_status(const RobotLinkState& state, std::chrono::system_clock::time_point now);

// Logs events of a frame, new damage of the map, faults of motion inputs, and a change of the verdict.
// last: report of the previous frame; map_damage: see Slam; source_of: topic of a sensor.
void log_changes(const FrameReport& report, const std::optional<FrameReport>& last,
                 const std::optional<std::string>& map_damage,
                 const std::function<std::string(MotionSensor sensor)>& source_of, const NodeLog& log);

// Time, state, health and map pose as one line of JSON.
std::string health_line(const FrameReport& report);

// Counters of a node since its start.
struct NodeCounters {
  int images = 0;   // left images received
  int skipped = 0;  // left images skipped for newer ones
  int frames = 0;   // frames tracked
  std::optional<FrameReport> last{};
};

// Prometheus text format, https://prometheus.io/docs/instrumenting/exposition_formats
std::string metrics_text(const NodeCounters& counters);

}  // namespace byre
