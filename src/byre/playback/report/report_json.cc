#include "byre/playback/report/report_json.h"

#include "byre/base/printable.h"

#include <cmath>

#include <nlohmann/json.hpp>

namespace byre {
namespace {

using Json = nlohmann::ordered_json;

Json agreement_json(const std::optional<Agreement>& agreement) {
  if (!agreement) return nullptr;
  return {{"translation_m", agreement->translation}, {"rotation_rad", agreement->rotation}};
}

Json condition_json(const std::optional<ImageCondition>& image) {
  if (!image) return nullptr;
  return {{"brightness", image->brightness},
          {"contrast", image->contrast},
          {"clipped", image->clipped},
          {"sharpness", image->sharpness},
          {"noise", image->noise}};
}

}  // namespace

Json health_json(const Health& health) {
  return {{"verdict", to_string(health.verdict)},
          {"doubt", to_string(health.doubt)},
          {"offline_expected", health.offline_expected},
          {"offline_matches", health.offline_matches},
          {"offline_inliers", health.offline_inliers},
          {"online_inliers", health.online_inliers},
          {"suspended", health.suspended},
          {"inlier_share", health.inlier_share},
          {"spread", health.spread},
          {"agreement", agreement_json(health.agreement)},
          {"position_sigma_m", health.position_sigma},
          {"rotation_sigma_rad", health.rotation_sigma},
          {"distance_since_offline_m", health.distance_since_offline},
          {"seconds_since_offline", health.seconds_since_offline},
          {"focal_error_percent", 100.0 * health.focal_error},
          {"hidden_share", health.hidden_share},
          {"hidden_share_right", health.hidden_share_right},
          {"image", condition_json(health.image)}};
}

Json pose_json(const Pose& frame_from_body, const Matrix6& covariance) {
  const Eigen::Quaterniond& q = frame_from_body.rotation;
  Json json = {{"position_m", position_json(frame_from_body)}, {"quaternion_xyzw", {q.x(), q.y(), q.z(), q.w()}}};
  Json entries = Json::array();
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 6; ++column) entries.push_back(covariance(row, column));
  }
  json["body_covariance"] = entries;
  return json;
}

Json position_json(const std::optional<Pose>& frame_from_body) {
  if (!frame_from_body) return nullptr;
  const Eigen::Vector3d& t = frame_from_body->translation;
  return {t.x(), t.y(), t.z()};
}

Json registration_json(const PlanRegistration& registration) {
  const Pose& pose = registration.plan_from_map.target_from_source;
  const Eigen::Vector4d quaternion = pose.rotation.coeffs();
  Json json = {{"plan", registration.plan},
               {"scale", registration.plan_from_map.scale},
               {"translation_m", {pose.translation.x(), pose.translation.y(), pose.translation.z()}},
               {"quaternion_xyzw", {quaternion.x(), quaternion.y(), quaternion.z(), quaternion.w()}},
               {"covariance", Json::array()}};
  for (const double value : registration.covariance.reshaped<Eigen::RowMajor>()) json["covariance"].push_back(value);
  return json;
}

double rounded_ms(double milliseconds) {
  return std::round(1e3 * milliseconds) / 1e3;
}

std::string dump_json(const Json& json, int indent) {
  return printable_json(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

}  // namespace byre
