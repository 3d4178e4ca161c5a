#pragma once

#include "byre/floor_plan.h"
#include "byre/plan_registration.h"
#include "byre/viewer/scene.h"
#include "byre/viewer/web/web_run.h"

#include <optional>
#include <span>
#include <string>

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

// Plan image as PNG, reduced to max_side pixels for browsers. Throws InputError if it cannot be read.
std::string plan_png(const FloorPlan& plan, int max_side = 4096);

// Binary messages to the page, little-endian; decoded by web/src/decode.ts.

// uint32 counts of points and keyframes; float32 x, y, z per point; float32 x, y, z and quaternion x, y, z, w per
// keyframe (map_from_body); uint8 origin per point and per keyframe: 0 offline, 1 online.
std::string map_bytes(const MapScene& scene);

// uint32 frame number and count of points; float32 u, v of all points; uint8 flags of all points (1 online, 2 inlier);
// then a JPEG file.
std::string image_bytes(std::size_t frame, std::span<const SeenPoint> seen, std::span<const unsigned char> jpeg);

}  // namespace byre
