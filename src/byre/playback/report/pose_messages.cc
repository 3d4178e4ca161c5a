#include "byre/playback/report/pose_messages.h"

namespace byre {
namespace {

using RowMajor6 = Eigen::Matrix<double, 6, 6, Eigen::RowMajor>;

ros::Quaternion ros_rotation(const Eigen::Quaterniond& rotation) {
  return {rotation.x(), rotation.y(), rotation.z(), rotation.w()};
}

ros::Vector3 ros_vector(const Eigen::Vector3d& vector) {
  return {vector.x(), vector.y(), vector.z()};
}

}  // namespace

ros::Pose ros_pose(const Pose& parent_from_child) {
  const Eigen::Vector3d& position = parent_from_child.translation;
  return {{position.x(), position.y(), position.z()}, ros_rotation(parent_from_child.rotation)};
}

ros::TransformStamped transform_message(const ros::Header& header, const std::string& child_frame,
                                        const Pose& parent_from_child) {
  return {header, child_frame, {ros_vector(parent_from_child.translation), ros_rotation(parent_from_child.rotation)}};
}

std::array<double, 36> ros_covariance(const Matrix6& covariance_in_child, const Eigen::Quaterniond& parent_from_child) {
  Matrix6 turn = Matrix6::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = parent_from_child.toRotationMatrix();
  std::array<double, 36> covariance{};
  Eigen::Map<RowMajor6>(covariance.data()) = turn * covariance_in_child * turn.transpose();
  return covariance;
}

ros::PoseWithCovarianceStamped pose_message(const ros::Header& header, const Pose& parent_from_child,
                                            const Matrix6& covariance_in_child) {
  return {header, {ros_pose(parent_from_child), ros_covariance(covariance_in_child, parent_from_child.rotation)}};
}

ros::Twist twist_between(const Pose& parent_from_before, const Pose& parent_from_after, Timestamp passed) {
  const double seconds = to_seconds(passed);
  const Eigen::Vector3d step = parent_from_after.translation - parent_from_before.translation;
  const Eigen::Vector3d turn = rotation_log(parent_from_before.rotation.conjugate() * parent_from_after.rotation);
  return {ros_vector(parent_from_after.rotation.conjugate() * step / seconds), ros_vector(turn / seconds)};
}

}  // namespace byre
