#pragma once

#include "byre/plan_registration.h"
#include "byre/pose.h"
#include "byre/slam/frame/health.h"

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace byre {

nlohmann::ordered_json list_json(const Eigen::VectorXd& values);

// Keys carry units (docs/reference/health_and_events.md).
nlohmann::ordered_json health_json(const Health& health);

// Keys position_m, quaternion_xyzw and body_covariance (of a small motion in the body frame, row-major).
nlohmann::ordered_json pose_json(const Pose& frame_from_body, const Matrix6& covariance);

nlohmann::ordered_json position_json(const std::optional<Pose>& frame_from_body);

// Pose of a map on a plan. Keys carry units; covariance row-major, see PlanRegistration.
nlohmann::ordered_json registration_json(const PlanRegistration& registration);

// Rounded to microseconds; further digits are noise.
double rounded_ms(double milliseconds);

// One line, or indented by indent spaces. Replaces invalid UTF-8 and escapes control characters.
std::string dump_json(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace byre
