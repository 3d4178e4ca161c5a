#pragma once

#include "byre/pose.h"
#include "byre/slam/health.h"

#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace byre::cli {

// With units in the names, as docs/mission.md describes it.
nlohmann::ordered_json health_json(const Health& health);

// position_m, quaternion_xyzw and body_covariance: of a small motion as seen in the body, row-major.
nlohmann::ordered_json pose_json(const Pose& frame_from_body, const Matrix6& covariance);

nlohmann::ordered_json position_json(const std::optional<Pose>& frame_from_body);  // null without a pose

// One line, or indented by so many spaces; bytes that are not UTF-8 are replaced.
std::string dumped(const nlohmann::ordered_json& json, int indent = -1);

}  // namespace byre::cli
