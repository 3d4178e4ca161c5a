#include "byre/ros2/fleet/fleet_link.h"

#include <utility>

namespace byre {
namespace {

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
