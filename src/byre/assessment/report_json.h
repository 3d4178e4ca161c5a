#pragma once

#include "byre/map/plan_registration.h"
#include "byre/pose.h"
#include "byre/slam/health.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

// With units in the names, as docs/mission.md describes it.
nlohmann::ordered_json health_json(const Health& health);

// position_m, quaternion_xyzw and body_covariance: of a small motion as seen in the body, row-major.
nlohmann::ordered_json pose_json(const Pose& frame_from_body, const Matrix6& covariance);

nlohmann::ordered_json position_json(const std::optional<Pose>& frame_from_body);  // null without a pose

// Where a map lies on a plan, with units in the names; the covariance row by row, see PlanRegistration.
nlohmann::ordered_json registration_json(const PlanRegistration& registration);

// One line, or indented by so many spaces. Bytes that are not UTF-8 are replaced, control characters escaped.
std::string dumped(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace byre
