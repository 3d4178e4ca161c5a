#include "byre/ros2/node/message_parsing.h"

#include "byre/io/recording/bag_motion.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {

std::optional<PoseHint> hint_of(const ros::PoseWithCovarianceStamped& message) {
  constexpr double kMinRadius = 3.0, kMinTurn = 1.0;  // metres, radians
  constexpr std::size_t kVarianceX = 0, kVarianceY = 7, kVarianceYaw = 35;
  const auto& position = message.pose.pose.position;
  const auto& covariance = message.pose.covariance;
  const Eigen::Vector3d translation(position.x, position.y, position.z);
  if (!translation.allFinite()) return std::nullopt;
  const auto pose = pose_of(message.pose.pose);  // empty without a direction
  PoseHint hint;
  hint.map_from_body = pose.value_or(Pose{Eigen::Quaterniond::Identity(), translation});
  hint.radius = std::max(kMinRadius, 3.0 * std::sqrt(std::max(covariance[kVarianceX], covariance[kVarianceY])));
  hint.turn = pose ? std::max(kMinTurn, 3.0 * std::sqrt(covariance[kVarianceYaw])) : std::numbers::pi;
  return hint;
}

}  // namespace byre
