#include "byre/motion/motion_covariance.h"

#include <algorithm>
#include <cmath>

namespace byre {
namespace {

void set_way_sigma(BodyMotion& motion, double sigma) {
  motion.covariance.topLeftCorner<3, 3>() = sigma * sigma * Eigen::Matrix3d::Identity();
}

void set_turn_sigma(BodyMotion& motion, double sigma) {
  motion.covariance.bottomRightCorner<3, 3>() = sigma * sigma * Eigen::Matrix3d::Identity();
}

}  // namespace

Matrix6 wheel_covariance(const Pose& motion, const Pose& base, const WheelMounting& mounting) {
  constexpr double kLeastShare = 0.01;
  constexpr double kTurnPerMetre = 0.01;  // radians
  constexpr double kLeastMetres = 1e-3;
  constexpr double kLeastTurn = 5e-4;  // radians
  const double way = motion.translation.norm();
  const double turn = rotation_log(motion.rotation).norm();
  const double arm_sigma = std::sqrt(mounting.covariance.bottomRightCorner<2, 2>().trace());  // metres
  const double way_sigma =
      way * std::hypot(std::max(kLeastShare, mounting.way_error), mounting.scale_sigma) +
      (turn * arm_sigma + kLeastMetres + mounting.side_error * std::abs(way_across(base))) / mounting.metres_per_unit;
  const double turn_sigma =
      turn * std::max(kLeastShare, mounting.turn_error) + kTurnPerMetre * way * mounting.metres_per_unit + kLeastTurn;
  Matrix6 covariance = Matrix6::Zero();
  covariance.diagonal().head<3>().setConstant(way_sigma * way_sigma);
  covariance.diagonal().tail<3>().setConstant(turn_sigma * turn_sigma);
  return covariance;
}

void forget_way(BodyMotion& motion) {
  constexpr double kLeast = 0.01;  // lengths of the map
  set_way_sigma(motion, motion.last_from_body.translation.norm() + kLeast);
}

void forget_turn(BodyMotion& motion) {
  constexpr double kLeast = 0.02;  // radians
  set_turn_sigma(motion, rotation_log(motion.last_from_body.rotation).norm() + kLeast);
}

void set_turn_covariance(BodyMotion& motion, const GyroscopeMounting& gyroscope, double seconds) {
  constexpr double kLeast = 1e-4;  // radians
  set_turn_sigma(motion, gyroscope.error * seconds + kLeast);
}

BodyMotion at_rest(BodyMotion motion, double seconds) {
  constexpr double kShare = 0.1;   // share of the motion from wheels
  constexpr double kCreep = 2e-4;  // lengths of the map per second
  constexpr double kTurn = 5e-5;   // radians per second
  motion.covariance.setZero();
  set_way_sigma(motion, kShare * motion.last_from_body.translation.norm() + kCreep * seconds);
  set_turn_sigma(motion, kShare * rotation_log(motion.last_from_body.rotation).norm() + kTurn * seconds);
  return motion;
}

}  // namespace byre
