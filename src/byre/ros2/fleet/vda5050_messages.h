#pragma once

#include "byre/ros2/fleet/fleet_position.h"

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

namespace byre {

// Messages of VDA 5050, version 2.1, with the fields that byre can fill. See github.com/VDA5050/VDA5050, json_schemas/.

// Identity of a robot: the leading parts of its topics.
struct FleetIdentity {
  std::string interface_name = "uagv";
  std::string manufacturer = "byre";
  std::string serial_number = "byre";
};

// Fault of a manufacturer or serial number; empty if valid.
std::string_view fault_in_identity(std::string_view text);

// Topic such as "uagv/v2/byre/robot7/state".
std::string fleet_topic(const FleetIdentity& identity, std::string_view topic);

struct FleetHeader {
  std::uint32_t id = 0;  // number of the message on its topic
  std::chrono::system_clock::time_point time;
};

// Map of the position.
struct FleetMap {
  std::string id;
  std::string description;  // may be empty
};

enum class FleetConnection : std::uint8_t { online, offline, broken };

std::string connection_text(const FleetIdentity& identity, const FleetHeader& header, FleetConnection state);

std::string visualization_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                               const FleetMap& map);

// Fields without data have neutral values: no order, an empty battery, no emergency stop. The operating mode is MANUAL,
// which prevents orders. A position that is not trusted is an error: FATAL if invalid, else WARNING.
std::string state_text(const FleetIdentity& identity, const FleetHeader& header, const FleetPosition& position,
                       const FleetMap& map);

}  // namespace byre
