#include "byre/playback/report/report_json.h"

#include "byre/base/printable.h"

#include <cmath>
#include <vector>

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

Json list_json(const Eigen::VectorXd& values) {
  return std::vector<double>(values.begin(), values.end());
}

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
  return {{"position_m", list_json(frame_from_body.translation)},
          {"quaternion_xyzw", list_json(frame_from_body.rotation.coeffs())},
          {"body_covariance", list_json(covariance.reshaped<Eigen::RowMajor>())}};
}

Json position_json(const std::optional<Pose>& frame_from_body) {
  return frame_from_body ? list_json(frame_from_body->translation) : Json();
}

Json registration_json(const PlanRegistration& registration) {
  const auto& [scale, pose] = registration.plan_from_map;
  return {{"plan", registration.plan},
          {"scale", scale},
          {"translation_m", list_json(pose.translation)},
          {"quaternion_xyzw", list_json(pose.rotation.coeffs())},
          {"covariance", list_json(registration.covariance.reshaped<Eigen::RowMajor>())}};
}

double rounded_ms(double milliseconds) {
  return std::round(1e3 * milliseconds) / 1e3;
}

std::string dump_json(const Json& json, int indent) {
  return printable_json(json.dump(indent, ' ', false, Json::error_handler_t::replace));
}

}  // namespace byre
