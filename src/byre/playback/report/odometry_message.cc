#include "byre/playback/report/odometry_message.h"

#include "byre/playback/report/pose_messages.h"

#include <algorithm>

namespace byre {
namespace {

// Standard deviations of the acceleration of an indoor robot: m/s^2, rad/s^2. Nav2 limits them to 2.5 and 3.2.
constexpr double kAcceleration = 1.0;
constexpr double kTurnAcceleration = 2.0;

double position_variance(const Matrix6& covariance) {
  return covariance.topLeftCorner<3, 3>().trace();
}

double rotation_variance(const Matrix6& covariance) {
  return covariance.bottomRightCorner<3, 3>().trace();
}

bool is_known(const Matrix6& covariance) {
  return covariance.allFinite() && position_variance(covariance) > 0.0 && rotation_variance(covariance) > 0.0;
}

Matrix6 twist_covariance(const OdometrySample& before, const OdometrySample& now) {
  const double seconds = to_seconds(now.time - before.time);
  const Pose now_from_before = inverse(now.odom_from_base) * before.odom_from_base;
  Matrix6 covariance = (now.covariance + move_covariance(before.covariance, now_from_before)) / (seconds * seconds);
  // The mean velocity is that of the middle of the interval.
  const double speed_change = kAcceleration * seconds / 2.0, rate_change = kTurnAcceleration * seconds / 2.0;
  covariance.topLeftCorner<3, 3>().diagonal().array() += speed_change * speed_change;
  covariance.bottomRightCorner<3, 3>().diagonal().array() += rate_change * rate_change;
  return covariance;
}

}  // namespace

OdometrySample odometry_sample(const FrameReport& report, const Pose& odom_from_base) {
  OdometrySample sample{report.time, odom_from_base, report.odometry_covariance};
  const bool is_smaller = is_known(report.covariance) &&
                          position_variance(report.covariance) < position_variance(sample.covariance) &&
                          rotation_variance(report.covariance) < rotation_variance(sample.covariance);
  if (report.map_from_body && is_smaller) sample.covariance = report.covariance;
  return sample;
}

ros::TwistWithCovariance twist_message(const std::optional<OdometrySample>& before, const OdometrySample& now) {
  ros::TwistWithCovariance message;
  Matrix6 covariance = kUnknownVariance * Matrix6::Identity();
  if (before && now.time > before->time) {
    message.twist = twist_between(before->odom_from_base, now.odom_from_base, now.time - before->time);
    if (is_known(before->covariance) && is_known(now.covariance)) covariance = twist_covariance(*before, now);
  }
  message.covariance = ros_covariance(covariance, Eigen::Quaterniond::Identity());
  return message;
}

}  // namespace byre
