#include "byre/ros2/fleet/fleet_link.h"

#include "byre/base/enum_names.h"
#include "byre/playback/report/report.h"
#include "byre/slam/frame/health.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <ctime>
#include <utility>

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

constexpr Timestamp kMaxSilence = std::chrono::seconds(3);  // time without frames after which the position is invalid
constexpr double kMaxDegraded = 0.4;
constexpr double kUntrusted = 0.1;

std::string problem_of(const FrameReport& report) {
  const Health& health = report.health;
  if (health.verdict == Verdict::trusted) return "";
  return std::string(to_string(health.verdict)).append(": ").append(to_string(health.doubt));
}

constexpr Timestamp kMaxBetweenStates = std::chrono::seconds(30);

std::string summary_of(const FleetPosition& position, const FleetMap& map) {
  return std::string(position.is_initialised ? "known " : "unknown ")
      .append(position.problem)
      .append(" ")
      .append(map.id);
}

MqttOptions named(MqttOptions broker, const FleetIdentity& identity) {
  broker.client_id = identity.manufacturer + "-" + identity.serial_number;
  return broker;
}

// The standard requires retained and acknowledged messages on the topic connection.
MqttClient::Presence presence_of(const FleetIdentity& identity) {
  const auto count = std::make_shared<std::atomic<std::uint32_t>>(0);
  const auto message = [identity, count](FleetConnection state) {
    const FleetHeader header{(*count)++, std::chrono::system_clock::now()};
    return MqttMessage{fleet_topic(identity, "connection"), connection_text(identity, header, state), true, true};
  };
  return {[message] { return message(FleetConnection::online); }, message(FleetConnection::broken),
          [message] { return message(FleetConnection::offline); }};
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

double localization_score(const FrameReport& report) {
  if (!report.map_from_body) return 0.0;
  if (report.health.verdict == Verdict::untrusted) return kUntrusted;
  const HealthOptions options;
  const double taken_up = position_error(report.health, options) / options.trusted_error;
  const double score = 1.0 - 0.5 * std::clamp(taken_up, 0.0, 1.0);
  return report.health.verdict == Verdict::trusted ? score : std::min(score, kMaxDegraded);
}

void FleetPositionKeeper::note(const FrameReport& report, Timestamp arrived, const std::string& advice) {
  const bool is_usable = report.map_from_body && report.health.verdict != Verdict::untrusted;
  position_.score = localization_score(report);
  position_.problem = problem_of(report);
  position_.advice = advice;
  position_.deviation.reset();
  if (is_usable) {
    const Eigen::Vector3d ahead = report.map_from_body->rotation * Eigen::Vector3d::UnitX();
    position_.x = report.map_from_body->translation.x();
    position_.y = report.map_from_body->translation.y();
    position_.theta = std::atan2(ahead.y(), ahead.x());
    position_.deviation = position_error(report.health, {});
    if (report.health.verdict == Verdict::trusted) position_.is_initialised = true;
  }
  if (report.state == State::lost || report.has(SessionEvent::navigation_error)) position_.is_initialised = false;

  position_.velocity.reset();
  if (report.odometry_from_body && odometry_ && report.time > odometry_->time) {
    const double seconds = to_seconds(report.time - odometry_->time);
    const Pose motion = inverse(odometry_->odometry_from_body) * *report.odometry_from_body;
    position_.velocity = FleetVelocity{motion.translation.x() / seconds, motion.translation.y() / seconds,
                                       rotation_log(motion.rotation).z() / seconds};
  }
  odometry_.reset();
  if (report.odometry_from_body) odometry_ = Odometry{report.time, *report.odometry_from_body};
  arrived_ = arrived;
}

void FleetPositionKeeper::restart() {
  position_.is_initialised = false;
  odometry_.reset();
}

FleetPosition FleetPositionKeeper::at(Timestamp now) const {
  FleetPosition position = position_;
  if (arrived_ && now - *arrived_ <= kMaxSilence) return position;
  position.is_initialised = false;
  position.score = 0.0;
  position.deviation.reset();
  position.velocity.reset();
  position.problem = arrived_ ? "no images arrive" : "no image has been tracked yet";
  position.advice = "check the camera and its driver";
  return position;
}

FleetReporter::FleetReporter(const FleetIdentity& identity, double rate, Send send)
    : identity_(identity), interval_(from_seconds(1.0 / rate)), send_(std::move(send)) {}

bool FleetReporter::is_state_due(const std::string& summary, Timestamp now, int connections) const {
  if (!state_ || connections != connections_ || now - state_->at >= kMaxBetweenStates) return true;
  return summary != state_->summary && now - state_->at >= interval_;
}

void FleetReporter::publish(const FleetPosition& position, const FleetMap& map, Timestamp now, WallTime wall,
                            int connections) {
  if (connections == 0) return;
  if (std::string summary = summary_of(position, map); is_state_due(summary, now, connections)) {
    send_({fleet_topic(identity_, "state"), state_text(identity_, {states_++, wall}, position, map)});
    state_ = SentState{now, std::move(summary)};
    connections_ = connections;
  }
  if (visualization_ && now - *visualization_ < interval_) return;
  send_({fleet_topic(identity_, "visualization"),
         visualization_text(identity_, {visualizations_++, wall}, position, map)});
  visualization_ = now;
}

FleetLink::FleetLink(const FleetOptions& options)
    : client_(named(options.broker, options.identity), presence_of(options.identity)),
      reporter_(options.identity, options.rate, [this](const MqttMessage& message) { client_.publish(message); }) {}

void FleetLink::note(const FrameReport& report, Timestamp arrived, const std::string& advice) {
  keeper_.note(report, arrived, advice);
}

void FleetLink::publish(const FleetMap& map, Timestamp now) {
  if (!client_.is_connected()) return;
  reporter_.publish(keeper_.at(now), map, now, std::chrono::system_clock::now(), client_.connections());
}

std::optional<std::string> FleetLink::connection_change() {
  std::string state = client_.state();
  if (state == last_connection_) return std::nullopt;
  last_connection_ = std::move(state);
  return last_connection_;
}

}  // namespace byre
