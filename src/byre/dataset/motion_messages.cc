#include "byre/dataset/motion_messages.h"

namespace byre {

std::optional<Pose> pose_of(const ros::Pose& message) {
  const auto& [position, orientation] = message;
  const Eigen::Quaterniond rotation(orientation.w, orientation.x, orientation.y, orientation.z);
  const Eigen::Vector3d translation(position.x, position.y, position.z);
  if (!translation.allFinite() || !(rotation.norm() > 0.5)) return std::nullopt;
  return Pose{rotation.normalized(), translation};
}

std::optional<StampedPose> sample_of(const ros::Odometry& message, Timestamp time) {
  const auto pose = pose_of(message.pose.pose);
  return pose ? std::optional(StampedPose{time, *pose}) : std::nullopt;
}

std::optional<AngularRate> sample_of(const ros::Imu& message, Timestamp time) {
  const auto& [x, y, z] = message.angular_velocity;
  const Eigen::Vector3d rate(x, y, z);
  return rate.allFinite() ? std::optional(AngularRate{time, rate}) : std::nullopt;
}

}  // namespace byre
