#pragma once

#include "byre/floor_plan.h"
#include "byre/map/plan_registration.h"
#include "byre/viewer/run_mailbox.h"

#include <optional>

#include <nlohmann/json.hpp>

namespace byre {

// What goes to the page as text; web/src/types.ts names the same fields. Lengths are metres in the map's frame, a pose
// is x, y, z and a quaternion x, y, z, w.

nlohmann::json pose_fields(const Pose& a_from_b);
nlohmann::json vector_fields(const Eigen::Vector3d& vector);

// Report of a frame, shortened to what the page shows.
nlohmann::json frame_fields(const ShownFrame& frame);

nlohmann::json camera_fields(const Rig& rig);
nlohmann::json plan_fields(const FloorPlan& plan);
nlohmann::json registration_fields(const PlanRegistration& registration);

// null without a value.
template <typename Value, typename Fields>
nlohmann::json fields_or_null(const std::optional<Value>& value, Fields fields) {
  return value ? nlohmann::json(fields(*value)) : nlohmann::json();
}

// Bytes that are not UTF-8, as names of files may hold, are replaced.
std::string dumped(const nlohmann::json& json);

}  // namespace byre
