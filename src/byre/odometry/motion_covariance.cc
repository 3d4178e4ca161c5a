#include "byre/odometry/motion_covariance.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

void set_translation_sigma(BodyMotion& motion, double sigma) {
  motion.covariance.topLeftCorner<3, 3>() = sigma * sigma * Eigen::Matrix3d::Identity();
}

void set_rotation_sigma(BodyMotion& motion, double sigma) {
  motion.covariance.bottomRightCorner<3, 3>() = sigma * sigma * Eigen::Matrix3d::Identity();
}

}  // namespace

Matrix6 wheel_covariance(const Pose& motion, const Pose& base, const WheelCalibration& calibration) {
  constexpr double kLeastShare = 0.01;
  constexpr double kTurnPerMetre = 0.01;  // radians
  constexpr double kLeastMetres = 1e-3;
  constexpr double kLeastTurn = 5e-4;  // radians
  const double way = motion.translation.norm();
  const double turn = rotation_log(motion.rotation).norm();
  const double direction_sigma = std::hypot(calibration.heading_sigma(), calibration.tilt_sigma());
  const double translation_sigma = way * std::hypot(std::max(kLeastShare, calibration.translation_error),
                                                    calibration.scale_sigma(), std::min(direction_sigma, 1.0)) +
                                   (turn * calibration.arm_sigma() + kLeastMetres +
                                    calibration.lateral_error * std::abs(lateral_displacement(base))) /
                                       calibration.metres_per_unit;
  const double turn_sigma =
      turn * std::hypot(std::max(kLeastShare, calibration.rotation_error), std::min(calibration.tilt_sigma(), 1.0)) +
      kTurnPerMetre * way * calibration.metres_per_unit + kLeastTurn;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(translation_sigma * translation_sigma);
  covariance.diagonal().tail<3>().setConstant(turn_sigma * turn_sigma);
  return covariance;
}

void set_translation_unknown(BodyMotion& motion) {
  constexpr double kLeast = 0.01;  // lengths of the map
  set_translation_sigma(motion, motion.last_from_body.translation.norm() + kLeast);
}

void set_rotation_unknown(BodyMotion& motion) {
  constexpr double kLeast = 0.02;  // radians
  set_rotation_sigma(motion, rotation_log(motion.last_from_body.rotation).norm() + kLeast);
}

void set_turn_covariance(BodyMotion& motion, const GyroscopeCalibration& gyroscope, double seconds) {
  constexpr double kLeast = 1e-4;  // radians
  set_rotation_sigma(motion, gyroscope.error * seconds + kLeast);
}

BodyMotion constrain_to_standstill(BodyMotion motion, double seconds) {
  constexpr double kShare = 0.1;   // share of the motion from wheels
  constexpr double kCreep = 2e-4;  // lengths of the map per second
  constexpr double kTurn = 5e-5;   // radians per second
  motion.covariance.setZero();
  set_translation_sigma(motion, kShare * motion.last_from_body.translation.norm() + kCreep * seconds);
  set_rotation_sigma(motion, kShare * rotation_log(motion.last_from_body.rotation).norm() + kTurn * seconds);
  return motion;
}

}  // namespace byre
