#pragma once

#include "byre/fleet/mqtt_client.h"
#include "byre/fleet/vda5050_messages.h"

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

namespace byre {

// When which message of VDA 5050 is published: visualization at a rate, state when it changes,
// upon each connection, and every 30 s at latest.
class FleetReporter {
 public:
  using Send = std::function<void(const MqttMessage&)>;
  using WallTime = std::chrono::system_clock::time_point;

  // rate: most messages a second on a topic
  FleetReporter(const FleetIdentity& identity, double rate, Send send);

  // now: a time that never goes back; connections: those made so far
  void tell(const FleetPosition& position, const FleetMap& map, Timestamp now, WallTime wall, int connections);

 private:
  struct Told {
    Timestamp at{};
    std::string summary;  // what must change to be told at once
  };

  bool is_state_due(const std::string& summary, Timestamp now, int connections) const;

  // Constant after construction.
  FleetIdentity identity_;
  Timestamp interval_;
  Send send_;

  std::uint32_t states_ = 0, visualizations_ = 0;  // messages so far
  std::optional<Told> state_;
  std::optional<Timestamp> visualization_;  // time of the last one
  int connections_ = 0;                     // connections that state was told upon
};

}  // namespace byre
