#pragma once

#include "byre/ros2/fleet/mqtt_client.h"
#include "byre/ros2/fleet/vda5050_messages.h"

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace byre {

// Schedules VDA 5050 messages: visualization at a fixed rate; state on change, after each connection, and at least
// every 30 s.
class FleetReporter {
 public:
  using Send = std::function<void(const MqttMessage&)>;
  using WallTime = std::chrono::system_clock::time_point;

  // rate: largest number of messages per second and topic
  FleetReporter(const FleetIdentity& identity, double rate, Send send);

  // now: of a monotonic clock; connections: number of connections so far
  void publish(const FleetPosition& position, const FleetMap& map, Timestamp now, WallTime wall, int connections);

 private:
  struct SentState {
    Timestamp at{};
    std::string summary;  // content whose change triggers a message
  };

  bool is_state_due(const std::string& summary, Timestamp now, int connections) const;

  // Constant after construction.
  FleetIdentity identity_;
  Timestamp interval_;
  Send send_;

  std::uint32_t states_ = 0, visualizations_ = 0;  // messages so far
  std::optional<SentState> state_;
  std::optional<Timestamp> visualization_;  // time of the last message
  int connections_ = 0;                     // number of connections at the last state message
};

struct FleetOptions {
  MqttOptions broker;  // the client id is derived from the identity
  FleetIdentity identity;
  double rate = 2.0;  // largest number of messages per second and topic
};

// Publishes the robot's position to a fleet manager by MQTT. Call it from one thread; never blocks.
class FleetLink {
 public:
  explicit FleetLink(const FleetOptions& options);

  // Adds a frame, see FleetPositionKeeper.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);
  void restart() { keeper_.restart(); }

  // Publishes due messages. now: of a monotonic clock.
  void publish(const FleetMap& map, Timestamp now);

  // Change of the connection state, a line of text.
  std::optional<std::string> connection_change();

 private:
  FleetPositionKeeper keeper_;
  std::string last_connection_;
  MqttClient client_;
  FleetReporter reporter_;
};

}  // namespace byre
