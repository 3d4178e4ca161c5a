#include "byre/viewer/web/web_json.h"

#include "byre/base/printable.h"

#include <cmath>

namespace byre {
namespace {

using Json = nlohmann::json;

constexpr double kMillimetresPerMetre = 1e3;
constexpr double kMillisecondsPerSecond = 1e3;

// Four decimals for short messages: 0.1 mm, and 0.01 degrees of a quaternion.
double rounded(double value) {
  return std::round(1e4 * value) / 1e4;
}

Json short_pose(const Pose& map_from_body) {
  Json fields = pose_fields(map_from_body);
  for (Json& field : fields) field = rounded(field);
  return fields;
}

}  // namespace

Json vector_fields(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

Json pose_fields(const Pose& a_from_b) {
  const Eigen::Vector3d& origin = a_from_b.translation;
  const Eigen::Quaterniond& rotation = a_from_b.rotation;
  return {origin.x(), origin.y(), origin.z(), rotation.x(), rotation.y(), rotation.z(), rotation.w()};
}

Json frame_fields(const ShownFrame& frame) {
  const FrameReport& report = frame.report;
  const Health& health = report.health;
  Json fields = {{"time_s", to_seconds(report.time)},
                 {"state", to_string(report.state)},
                 {"verdict", to_string(health.verdict)},
                 {"doubt", to_string(health.doubt)},
                 {"pose", fields_or_null(report.map_from_body, short_pose)},
                 {"offline_inliers", health.offline_inliers},
                 {"offline_expected", health.offline_expected},
                 {"online_inliers", health.online_inliers},
                 {"expected", report.expected_points},
                 {"matches", report.matches},
                 {"features", report.features},
                 {"suspended", health.suspended},
                 {"inlier_share", rounded(health.inlier_share)},
                 {"spread", rounded(health.spread)},
                 {"sigma_mm", rounded(kMillimetresPerMetre * health.position_sigma)},
                 {"since_offline_m", rounded(health.distance_since_offline)},
                 {"track_ms", rounded(kMillisecondsPerSecond * report.track_seconds)},
                 {"online_keyframes", frame.online_keyframes},
                 {"online_points", frame.online_points}};
  if (health.agreement) fields["disagreement_mm"] = rounded(kMillimetresPerMetre * health.agreement->translation);
  for (const SessionEvent event : report.events) fields["events"].push_back(to_string(event));
  return fields;
}

Json camera_fields(const Rig& rig) {
  return {{"width", rig.width}, {"height", rig.height}, {"focal", rig.focal},
          {"cx", rig.cx},       {"cy", rig.cy},         {"body_from_camera", pose_fields(rig.body_from_camera)}};
}

Json plan_fields(const FloorPlan& plan) {
  const Eigen::Matrix2d& step = plan.metres_per_pixel;
  return {{"name", plan.name},
          {"width", plan.width},
          {"height", plan.height},
          {"step_right", {step(0, 0), step(1, 0)}},
          {"step_down", {step(0, 1), step(1, 1)}},
          {"top_left", {plan.top_left_in_plan.x(), plan.top_left_in_plan.y()}}};
}

Json registration_fields(const PlanRegistration& registration) {
  const Pose& placed = registration.plan_from_map.target_from_source;
  return {{"plan", registration.plan}, {"scale", registration.plan_from_map.scale}, {"pose", pose_fields(placed)}};
}

std::string dump_json(const Json& json) {
  return printable_json(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

}  // namespace byre
