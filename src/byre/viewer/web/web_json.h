#pragma once

#include "byre/floor_plan.h"
#include "byre/map/plan_registration.h"
#include "byre/viewer/web/run_mailbox.h"

#include <optional>

#include <nlohmann/json.hpp>

namespace byre {

// JSON messages to the page; web/src/types.ts has the same fields. Metres in the map frame; poses are x, y, z and
// quaternion x, y, z, w.

nlohmann::json pose_fields(const Pose& a_from_b);
nlohmann::json vector_fields(const Eigen::Vector3d& vector);

// Fields of a frame report that the page shows.
nlohmann::json frame_fields(const ShownFrame& frame);

nlohmann::json camera_fields(const Rig& rig);
nlohmann::json plan_fields(const FloorPlan& plan);
nlohmann::json registration_fields(const PlanRegistration& registration);

// Fields, or null without a value.
template <typename Value, typename Fields>
nlohmann::json fields_or_null(const std::optional<Value>& value, Fields fields) {
  return value ? nlohmann::json(fields(*value)) : nlohmann::json();
}

// JSON text; invalid UTF-8, possible in file names, is replaced.
std::string dump_json(const nlohmann::json& json);

}  // namespace byre
