#include "byre/ros2/fleet/fleet_link.h"

#include <utility>

namespace byre {
namespace {

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
