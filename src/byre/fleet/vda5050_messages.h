#pragma once

#include "byre/fleet/fleet_position.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// Messages of VDA 5050, version 2.1, as far as byre knows what they tell. See github.com/VDA5050/VDA5050,
// json_schemas/.

// Who a robot is among others. Together they are the first parts of all topics' names.
struct FleetIdentity {
  std::string interface_name = "uagv";
  std::string manufacturer = "byre";
  std::string serial_number = "byre";
};

// Why a text cannot be a manufacturer or a serial number; empty where it can.
std::string_view fault_in_identity(std::string_view text);

// "uagv/v2/byre/robot7/state"
std::string fleet_topic(const FleetIdentity& identity, std::string_view topic);

struct FleetHeader {
  std::uint32_t id = 0;  // count of messages on the topic
  std::chrono::system_clock::time_point time;
};

// The map that the position is in.
struct FleetMap {
  std::string id;
  std::string description;  // may be empty
};

enum class FleetConnection : std::uint8_t { online, offline, broken };

std::string connection_text(const FleetIdentity& identity, const FleetHeader& header, FleetConnection state);

std::string visualization_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                               const FleetMap& map);

// What byre does not know has the value for nothing: no order, an empty battery, no emergency stop. The operating mode
// is MANUAL, so that nobody gives orders. A position that is not trusted is an error: FATAL while it is not known where
// the robot is, else WARNING.
std::string state_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                       const FleetMap& map);

}  // namespace byre
