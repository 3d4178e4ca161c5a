#pragma once

#include "byre/fleet/fleet_reporter.h"

#include <atomic>
#include <memory>
#include <optional>
#include <string>

namespace byre {

struct FleetOptions {
  MqttOptions broker;  // the client's id is made of who the robot is
  FleetIdentity identity;
  double rate = 2.0;  // most messages a second on a topic
};

// Tells a fleet by MQTT where the robot is. Called from one thread; waits for nobody.
class FleetLink {
 public:
  explicit FleetLink(const FleetOptions& options);

  // A frame, as FleetPositionKeeper takes it.
  void note(const FrameReport& report, Timestamp arrived, const std::string& advice);
  void begin_anew() { keeper_.begin_anew(); }

  // Publishes what is due. now: a time that never goes back
  void tell(const FleetMap& map, Timestamp now);

  // What is new of the connection, a line for people.
  std::optional<std::string> news();

 private:
  FleetPositionKeeper keeper_;
  std::string last_news_;
  MqttClient client_;
  FleetReporter reporter_;
};

}  // namespace byre
