#pragma once

#include "byre/cli/register_run.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre::cli {

// A line for people: where the map's origin lies on the plan.
std::string describe_origin(const PlanRegistration& registration);

// With units in the names; the covariance row by row, see PlanRegistration.
nlohmann::ordered_json registration_json(const PlanRegistration& registration);

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

}  // namespace byre::cli
