#include "byre/io/recording/motion_messages.h"

#include <cmath>

namespace byre {
namespace {

std::optional<BaseTwist> velocity_of(const ros::Twist& twist, Timestamp time) {
  const BaseTwist velocity{time, twist.linear.x, twist.linear.y, twist.angular.z};
  const bool is_finite = std::isfinite(velocity.vx + velocity.vy + velocity.wz);
  return is_finite ? std::optional(velocity) : std::nullopt;
}

std::optional<WheelSample> sample_of(const std::optional<BaseTwist>& velocity, Timestamp time) {
  return velocity ? std::optional(WheelSample{time, {}, velocity}) : std::nullopt;
}

}  // namespace

std::optional<Pose> pose_of(const ros::Pose& message) {
  const auto& [position, orientation] = message;
  const Eigen::Quaterniond rotation(orientation.w, orientation.x, orientation.y, orientation.z);
  const Eigen::Vector3d translation(position.x, position.y, position.z);
  if (!translation.allFinite() || !(rotation.norm() > 0.5)) return std::nullopt;
  return Pose{rotation.normalized(), translation};
}

std::optional<WheelSample> sample_of(const ros::Odometry& message, Timestamp time) {
  const ros::Quaternion& turn = message.pose.pose.orientation;
  const bool has_no_turn = turn.w == 0.0 && turn.x == 0.0 && turn.y == 0.0 && turn.z == 0.0;
  const auto velocity = velocity_of(message.twist.twist, time);
  if (has_no_turn || message.pose.covariance[0] < 0.0) return sample_of(velocity, time);
  const auto pose = pose_of(message.pose.pose);
  return pose ? std::optional(WheelSample{time, pose, velocity}) : std::nullopt;
}

std::optional<WheelSample> sample_of(const ros::TwistStamped& message, Timestamp time) {
  return sample_of(velocity_of(message.twist, time), time);
}

std::optional<WheelSample> sample_of(const ros::TwistWithCovarianceStamped& message, Timestamp time) {
  return sample_of(velocity_of(message.twist.twist, time), time);
}

std::optional<ImuSample> sample_of(const ros::Imu& message, Timestamp time) {
  const auto vector_of = [](const ros::Vector3& told) { return Eigen::Vector3d(told.x, told.y, told.z); };
  const Eigen::Vector3d rate = vector_of(message.angular_velocity);
  const Eigen::Vector3d acceleration = vector_of(message.linear_acceleration);
  const bool has_rate = message.angular_velocity_covariance[0] != -1.0;
  if (has_rate && !rate.allFinite()) return std::nullopt;
  ImuSample sample{time};
  if (has_rate) sample.rate = {time, rate};
  const bool has_acceleration = message.linear_acceleration_covariance[0] != -1.0 && acceleration.allFinite();
  if (has_acceleration && !acceleration.isZero(0.0)) sample.acceleration = {time, acceleration};
  return sample;
}

}  // namespace byre
