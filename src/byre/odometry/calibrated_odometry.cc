#include "byre/odometry/calibrated_odometry.h"

#include "byre/odometry/visual_motion.h"

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

// Covariance of the body's motion from wheels, in lengths of the map. motion: of the body; base: of the base, metres.
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

// Sets the standard deviation of the translation to its length: spinning wheels may measure any path.
void set_translation_unknown(BodyMotion& motion) {
  constexpr double kLeast = 0.01;  // lengths of the map
  set_translation_sigma(motion, motion.last_from_body.translation.norm() + kLeast);
}

// Sets the standard deviation of the rotation to its angle.
void set_rotation_unknown(BodyMotion& motion) {
  constexpr double kLeast = 0.02;  // radians
  set_rotation_sigma(motion, rotation_log(motion.last_from_body.rotation).norm() + kLeast);
}

// Sets the covariance of a rotation that a gyroscope measured.
void set_turn_covariance(BodyMotion& motion, const GyroscopeCalibration& gyroscope, double seconds) {
  constexpr double kLeast = 1e-4;  // radians
  set_rotation_sigma(motion, gyroscope.error * seconds + kLeast);
}

// Zero-velocity update: the motion with the small covariance of a body at standstill, which bounds drift.
BodyMotion constrain_to_standstill(BodyMotion motion, double seconds) {
  constexpr double kShare = 0.1;   // share of the motion from wheels
  constexpr double kCreep = 2e-4;  // lengths of the map per second
  constexpr double kTurn = 5e-5;   // radians per second
  motion.covariance.setZero();
  set_translation_sigma(motion, kShare * motion.last_from_body.translation.norm() + kCreep * seconds);
  set_rotation_sigma(motion, kShare * rotation_log(motion.last_from_body.rotation).norm() + kTurn * seconds);
  return motion;
}

constexpr double kUnprovenFactor = 9.0;  // factor of the covariance of motions by an unproven calibration

// Whether wheels and gyroscope disagree about a turn, such as when a wheel spins or is lifted.
bool is_slip(const Eigen::Quaterniond& by_wheels, const Eigen::Quaterniond& by_gyroscope, double seconds) {
  constexpr double kRate = 0.1;   // radians per second
  constexpr double kShare = 0.2;  // share of the turn
  return angle_between(by_wheels, by_gyroscope) > kRate * seconds + kShare * rotation_log(by_gyroscope).norm();
}

// In the clock of the wheels.
Timestamp wheel_time(const CalibratedOdometry& odometry, Timestamp time) {
  return time + from_seconds(odometry.time_offset);
}

std::optional<Eigen::Quaterniond> gyroscope_rotation(const CalibratedOdometry& odometry, Timestamp earlier,
                                                     Timestamp later) {
  const std::optional<GyroscopeCalibration>& gyroscope = odometry.gyroscope;
  if (!gyroscope) return {};
  const auto measured = odometry.rates.between(earlier, later, gyroscope->bias);
  if (!measured) return {};
  return gyroscope->body_from_gyroscope * *measured * gyroscope->body_from_gyroscope.conjugate();
}

// Whether the motion of the base changes from the previous span by more than a body can: wheels spin, or are faulty.
bool exceeds_acceleration(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later, const Pose& base) {
  constexpr double kLeast = 0.02;      // metres, for encoder ticks
  constexpr double kLeastTurn = 0.05;  // radians
  const Timestamp span = later - earlier;
  if (span > kMaxFrameGap) return false;
  if (odometry.wheels.has_jump(wheel_time(odometry, earlier) - span, wheel_time(odometry, earlier))) return true;
  const auto before = base_between(odometry, earlier - span, earlier);
  if (!before) return false;
  const double squared = to_seconds(span) * to_seconds(span);
  return (base.translation - before->translation).norm() > kLeast + kMostAcceleration * squared ||
         angle_between(base.rotation, before->rotation) > kLeastTurn + kMostTurning * squared;
}

struct BaseMotion {
  Pose motion;                       // earlier_from_later, metres
  bool is_translation_valid = true;  // wheels agree with the gyroscope, if any, and show no jerk
  bool is_rotation_valid = true;     // measured by the gyroscope, or by wheels without a jerk
};

// turn: rotation of the body from the gyroscope; replaces that of the wheels. Precondition: there is a calibration.
std::optional<BaseMotion> base_motion(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                      const std::optional<Eigen::Quaterniond>& turn) {
  const auto measured = base_between(odometry, earlier, later);
  if (!measured) return {};
  BaseMotion base{without_turn_errors(odometry.calibration->turn_errors, *measured)};
  if (turn) {
    const Eigen::Quaterniond& base_from_body = odometry.calibration->base_from_body.rotation;
    const Eigen::Quaterniond base_turn = base_from_body * *turn * base_from_body.conjugate();
    base.is_translation_valid = !is_slip(base.motion.rotation, base_turn, to_seconds(later - earlier));
    base.motion.rotation = base_turn;
  }
  if (exceeds_acceleration(odometry, earlier, later, *measured)) {
    base.is_translation_valid = false;
    base.is_rotation_valid = turn.has_value();
  }
  return base;
}

// Standard deviation of the body's motion, as a delta, by that of the delay of the wheels: zero at constant speed.
Vector6 deviation_by_time_offset(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later) {
  const Timestamp shift = from_seconds(odometry.time_offset_sigma);
  auto shifted = base_between(odometry, earlier + shift, later + shift);
  if (!shifted) shifted = base_between(odometry, earlier - shift, later - shift);
  const auto base = base_between(odometry, earlier, later);
  if (!shifted || !base) return Vector6::Zero();
  const WheelCalibration& calibration = *odometry.calibration;
  return log_pose(inverse(body_motion(calibration, *base)) * body_motion(calibration, *shifted));
}

std::optional<BodyMotion> wheel_motion(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                       const std::optional<Eigen::Quaterniond>& turn) {
  if (odometry.calibration == nullptr) return {};
  const auto base = base_motion(odometry, earlier, later, turn);
  if (!base) return {};
  const Pose body = body_motion(*odometry.calibration, base->motion);
  BodyMotion motion{body, wheel_covariance(body, base->motion, *odometry.calibration)};
  const Vector6 deviation = deviation_by_time_offset(odometry, earlier, later);
  motion.covariance += deviation * deviation.transpose();
  if (odometry.is_unproven) motion.covariance *= kUnprovenFactor;
  if (!base->is_translation_valid) set_translation_unknown(motion);
  if (!base->is_rotation_valid) set_rotation_unknown(motion);
  return motion;
}

// Whether the turns by gyroscope and wheels differ by more than a spinning wheel explains. Then one of both is faulty.
bool contradicts_wheels(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                        const Eigen::Quaterniond& turn) {
  constexpr double kMostRate = 3.0;   // radians per second
  constexpr double kLeastTurn = 0.1;  // radians
  const auto base = base_between(odometry, earlier, later);
  if (!base) return false;
  const double apart = std::abs(rotation_log(turn).norm() - rotation_log(base->rotation).norm());
  return apart > kLeastTurn + kMostRate * to_seconds(later - earlier);
}

// Motion across a jump of the wheel pose: that of the previous span, with a standard deviation as large as itself.
std::optional<BodyMotion> bridge_jump(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                      const std::optional<Eigen::Quaterniond>& turn) {
  const Timestamp span = later - earlier;
  if (span > kMaxFrameGap) return {};
  if (!odometry.wheels.has_jump(wheel_time(odometry, earlier), wheel_time(odometry, later))) return {};
  auto motion = wheel_motion(odometry, earlier - span, earlier, {});
  // The jump may be right after the frame.
  if (!motion) motion = wheel_motion(odometry, earlier - 2 * span, earlier - span, {});
  if (!motion) return {};
  set_translation_unknown(*motion);
  set_rotation_unknown(*motion);
  if (turn) motion->last_from_body.rotation = *turn;
  return motion;
}

}  // namespace

std::optional<Pose> base_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later) {
  return odometry.wheels.between(wheel_time(odometry, earlier), wheel_time(odometry, later));
}

std::optional<Pose> base_path_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later) {
  const auto measured = base_motion(odometry, earlier, later, gyroscope_rotation(odometry, earlier, later));
  return measured ? std::optional(measured->motion) : std::nullopt;
}

std::optional<bool> are_wheels_stationary(const CalibratedOdometry& odometry, Timestamp time) {
  constexpr double kMostMetres = 0.0025;  // in the window: ticks of encoders
  constexpr double kMostRadians = 0.004;  // in the window
  if (odometry.is_slipping) return {};
  const Timestamp end = wheel_time(odometry, time);
  const auto distance = odometry.wheels.distance(end - SteadyWindow::kWindow, end);
  if (!distance) return {};
  return distance->metres <= kMostMetres && distance->radians <= kMostRadians;
}

std::optional<SteadyWindow::Steady> standstill_by_wheels(const CalibratedOdometry& odometry, Timestamp time) {
  if (!odometry.gyroscope) return {};
  return odometry.stationary.at(time, {are_wheels_stationary(odometry, time), std::nullopt}, odometry.gyroscope->bias);
}

std::optional<BodyMotion> motion_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                         const std::optional<BodyMotion>& predicted) {
  auto turn = gyroscope_rotation(odometry, earlier, later);
  const bool is_contradicted = turn && !odometry.is_slipping && contradicts_wheels(odometry, earlier, later, *turn);
  if (is_contradicted) turn.reset();
  auto motion = odometry.is_slipping ? std::nullopt : wheel_motion(odometry, earlier, later, turn);
  if (motion && is_contradicted) {
    set_translation_unknown(*motion);
    set_rotation_unknown(*motion);
  }
  if (!motion && !odometry.is_slipping) motion = bridge_jump(odometry, earlier, later, turn);
  if (!turn) return motion;
  const double seconds = to_seconds(later - earlier);
  if (motion && standstill_by_wheels(odometry, later)) return constrain_to_standstill(*motion, seconds);
  if (!motion && (motion = predicted)) motion->last_from_body.rotation = *turn;
  if (!motion) return {};
  set_turn_covariance(*motion, *odometry.gyroscope, seconds);
  return motion;
}

std::optional<double> reach_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                    double arm) {
  constexpr double kShare = 1.2;       // factor of the measured distance: wheels may slide
  constexpr double kLeast = 0.5;       // metres
  constexpr double kUnmeasured = 1.5;  // metres in the first second: failed encoders must not reject a tracked frame
  constexpr double kHalfTurns = 2.0;   // radii that turns on the spot can displace the body
  const auto distance = odometry.wheels.distance(wheel_time(odometry, earlier), wheel_time(odometry, later));
  if (!distance) return {};
  const double metres = kShare * distance->metres + std::min(distance->radians, kHalfTurns) * arm + kLeast +
                        kUnmeasured * std::clamp(to_seconds(later - earlier), 0.0, 1.0);
  return metres / (odometry.calibration != nullptr ? odometry.calibration->metres_per_unit : 1.0);
}

std::optional<BodyMotion> path_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later) {
  const auto turn = gyroscope_rotation(odometry, earlier, later);
  auto motion = wheel_motion(odometry, earlier, later, turn);
  if (motion && turn) set_turn_covariance(*motion, *odometry.gyroscope, to_seconds(later - earlier));
  return motion;
}

}  // namespace byre
