#include "byre/ros2/fleet/vda5050_messages.h"

#include "byre/base/enum_names.h"
#include "byre/playback/report/report_json.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ctime>

#include <fmt/core.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kVersion = "2.1.0";
constexpr std::string_view kTopicVersion = "v2";
constexpr std::string_view kMarks = "_.:-";  // permitted characters of identities besides letters and digits
constexpr double kStanding = 0.02;           // m/s and rad/s; below, the robot is at standstill

// Time such as "2026-11-23T14:05:06.123Z".
std::string utc(std::chrono::system_clock::time_point time) {
  const auto milliseconds = std::chrono::floor<std::chrono::milliseconds>(time).time_since_epoch().count();
  const auto seconds = static_cast<std::time_t>(milliseconds / 1000);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", parts.tm_year + 1900, parts.tm_mon + 1,
                     parts.tm_mday, parts.tm_hour, parts.tm_min, parts.tm_sec, static_cast<int>(milliseconds % 1000));
}

Json header_fields(const FleetIdentity& identity, const FleetHeader& header) {
  return {{"headerId", header.id},
          {"timestamp", utc(header.time)},
          {"version", kVersion},
          {"manufacturer", identity.manufacturer},
          {"serialNumber", identity.serial_number}};
}

Json position_fields(const FleetPosition& position, const FleetMap& map) {
  Json fields = {{"x", position.x},
                 {"y", position.y},
                 {"theta", position.theta},
                 {"mapId", map.id},
                 {"positionInitialized", position.is_initialised},
                 {"localizationScore", position.score}};
  if (!map.description.empty()) fields["mapDescription"] = map.description;
  if (position.deviation && std::isfinite(*position.deviation)) fields["deviationRange"] = *position.deviation;
  return fields;
}

void add_position(Json& message, const FleetPosition& position, const FleetMap& map) {
  message["agvPosition"] = position_fields(position, map);
  if (!position.velocity) return;
  const auto& [vx, vy, omega] = *position.velocity;
  message["velocity"] = {{"vx", vx}, {"vy", vy}, {"omega", omega}};
}

bool is_driving(const FleetPosition& position) {
  if (!position.velocity) return false;
  const auto& [vx, vy, omega] = *position.velocity;
  return std::hypot(vx, vy) > kStanding || std::abs(omega) > kStanding;
}

Json errors_of(const FleetPosition& position) {
  Json errors = Json::array();
  if (position.is_initialised && position.problem.empty()) return errors;
  Json error = {{"errorType", "LOCALIZATION_ERROR"},
                {"errorLevel", position.is_initialised ? "WARNING" : "FATAL"},
                {"errorDescription", position.problem.empty() ? "not trusted yet" : position.problem}};
  if (!position.advice.empty()) error["errorHint"] = position.advice;
  errors.push_back(std::move(error));
  return errors;
}

std::string_view name_of(FleetConnection state) {
  return name_among<FleetConnection::broken>({"ONLINE", "OFFLINE", "CONNECTIONBROKEN"}, state);
}

}  // namespace

std::string_view fault_in_identity(std::string_view text) {
  const auto is_allowed = [](unsigned char c) {
    return std::isalnum(c) != 0 || kMarks.find(c) != std::string_view::npos;
  };
  if (text.empty()) return "is empty";
  return std::ranges::all_of(text, is_allowed) ? "" : "contains characters other than letters, digits and _ . : -";
}

std::string fleet_topic(const FleetIdentity& identity, std::string_view topic) {
  std::string name = identity.interface_name;
  for (const std::string_view part :
       {kTopicVersion, std::string_view(identity.manufacturer), std::string_view(identity.serial_number), topic}) {
    name.append("/").append(part);
  }
  return name;
}

std::string connection_text(const FleetIdentity& identity, const FleetHeader& header, FleetConnection state) {
  Json message = header_fields(identity, header);
  message["connectionState"] = name_of(state);
  return dump_json(message);
}

std::string visualization_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                               const FleetMap& map) {
  Json message = header_fields(identity, header);
  add_position(message, position, map);
  return dump_json(message);
}

std::string state_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                       const FleetMap& map) {
  Json message = header_fields(identity, header);
  message["orderId"] = "";
  message["orderUpdateId"] = 0;
  message["lastNodeId"] = "";
  message["lastNodeSequenceId"] = 0;
  message["driving"] = is_driving(position);
  message["operatingMode"] = "MANUAL";
  for (const char* list : {"nodeStates", "edgeStates", "actionStates"}) message[list] = Json::array();
  add_position(message, position, map);
  message["batteryState"] = {{"batteryCharge", 0.0}, {"charging", false}};
  message["errors"] = errors_of(position);
  message["safetyState"] = {{"eStop", "NONE"}, {"fieldViolation", false}};
  return dump_json(message);
}

}  // namespace byre
