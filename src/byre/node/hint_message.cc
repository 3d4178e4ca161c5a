#include "byre/node/hint_message.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {

PoseHint hint_of(const ros::PoseWithCovarianceStamped& message) {
  constexpr double kLeastRadius = 3.0, kLeastTurn = 1.0;  // metres, radians
  constexpr std::size_t kVarianceX = 0, kVarianceY = 7, kVarianceYaw = 35;
  const auto& [position, orientation] = message.pose.pose;
  const auto& covariance = message.pose.covariance;
  PoseHint hint;
  hint.map_from_body.translation = {position.x, position.y, position.z};
  hint.radius = std::max(kLeastRadius, 3.0 * std::sqrt(std::max(covariance[kVarianceX], covariance[kVarianceY])));
  hint.turn = std::numbers::pi;
  const Eigen::Quaterniond rotation(orientation.w, orientation.x, orientation.y, orientation.z);
  if (rotation.norm() < 0.5) return hint;
  hint.map_from_body.rotation = rotation.normalized();
  hint.turn = std::max(kLeastTurn, 3.0 * std::sqrt(covariance[kVarianceYaw]));
  return hint;
}

}  // namespace byre
