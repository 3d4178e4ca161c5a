#pragma once

#include "byre/ros2/fleet/fleet_reporter.h"

#include <atomic>
#include <memory>
#include <optional>
#include <string>

namespace byre {

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
