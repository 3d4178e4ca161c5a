#pragma once

#include "byre/archive/register_map.h"

#include <optional>
#include <string>

namespace byre {

// What was registered, and where the result went; empty for nowhere.
struct RegisterProtocol {
  std::string map;
  FloorPlan plan;
  std::string written;
  std::optional<double> scaled_by;  // where the scale was to be mended; 1: there was nothing to mend
};

// A page for people, and the same for programs.
std::string to_text(const Registering& registering, const RegisterProtocol& protocol);
std::string to_json(const Registering& registering, const RegisterProtocol& protocol);

}  // namespace byre
