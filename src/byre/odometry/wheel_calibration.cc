#include "byre/odometry/wheel_calibration.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/median.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr double kLeastTurn = 0.8;      // radians, sum of all turns; the standard deviations decide
constexpr double kLeastWay = 1.0;       // metres, sum of all paths
constexpr double kMaxAxisError = 0.35;  // radians, median angle between the axes of turns in images
constexpr double kMaxSigma = 0.05;      // relative for the scale, radians for the direction
constexpr int kRounds = 8;              // rounds of reweighting

using Vector4 = Eigen::Vector4d;

double yaw_of(const Pose& base) {
  return rotation_log(base.rotation).z();
}

Eigen::Vector3d up_of(const WheelCalibration& calibration) {
  return calibration.base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
}

// The base's up axis in the body; empty if turns are too small, or have no common axis.
std::optional<Eigen::Vector3d> find_up(const std::vector<MotionPair>& motions,
                                       const std::optional<WheelCalibration>& known) {
  constexpr double kSmall = 0.03;  // radians, turns with a poorly determined axis
  constexpr double kKnown = 4.0;   // weight of the prior, sum of squared turns
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double turned = 0.0;
  if (known) {
    sum = kKnown * up_of(*known);
    turned = kLeastTurn;
  }
  for (const MotionPair& motion : motions) {
    sum += yaw_of(motion.base) * rotation_log(motion.body.rotation);
    turned += std::abs(yaw_of(motion.base));
  }
  if (turned < kLeastTurn || !(sum.norm() > 0.0)) return {};
  const Eigen::Vector3d up = sum.normalized();
  std::vector<double> errors;
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(motion.base);
    if (std::abs(yaw) < kSmall) continue;
    errors.push_back((rotation_log(motion.body.rotation) / yaw - up).norm());
  }
  return median_or(std::move(errors), kMaxAxisError) < kMaxAxisError ? std::optional(up) : std::nullopt;
}

// Least squares with Geman-McClure weights, with a prior of the usual errors of wheels.
TurnErrors find_turn_errors(const std::vector<MotionPair>& motions, const Eigen::Vector3d& up,
                            const std::optional<WheelCalibration>& known) {
  const double scale_sigma = known ? 0.005 : 0.03;       // share, from day to day or among wheels
  const double per_metre_sigma = known ? 0.001 : 0.005;  // radians per metre, from day to day or among wheels
  const TurnErrors before = known ? known->turn_errors : TurnErrors{};
  const Eigen::Matrix2d by_before =
      Eigen::Vector2d(1.0 / (scale_sigma * scale_sigma), 1.0 / (per_metre_sigma * per_metre_sigma)).asDiagonal();
  constexpr double kLeastError = 0.001;  // radians: limit of the images' accuracy
  TurnErrors found = before;
  double usual = 0.01;  // radians
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix2d normal = by_before;
    Eigen::Vector2d right = by_before * Eigen::Vector2d(before.scale - 1.0, before.per_metre);
    std::vector<double> errors;
    for (const MotionPair& motion : motions) {
      const Eigen::Vector2d factors(yaw_of(motion.base), motion.base.translation.x());
      const double extra = rotation_log(motion.body.rotation).dot(up) - factors[0];
      const double error = std::abs(extra - factors.dot(Eigen::Vector2d(found.scale - 1.0, found.per_metre)));
      const double weight = 1.0 / std::pow(usual * (1.0 + std::pow(error / (3.0 * usual), 2)), 2);
      normal += weight * factors * factors.transpose();
      right += weight * extra * factors;
      errors.push_back(error);
    }
    const Eigen::Vector2d solved = normal.ldlt().solve(right);
    found = {1.0 + solved[0], solved[1]};
    usual = std::max(median_or(std::move(errors), usual), kLeastError);
  }
  return found;
}

// One motion as two equations in metres, linear in (s cos, s sin, x, y): s metres per unit of the map, the angle from
// the levelled body to the base, and x and y the lever arm.
struct PlanarMotion {
  Eigen::Matrix<double, 2, 4> factors;
  Eigen::Vector2d base;
  double way = 0.0;  // metres, measured by wheels
};

PlanarMotion planar(const MotionPair& motion, const Eigen::Quaterniond& level_from_body) {
  const double yaw = yaw_of(motion.base);
  const Eigen::Vector3d seen = level_from_body * motion.body.translation;
  const double turned = 1.0 - std::cos(yaw), swept = std::sin(yaw);
  PlanarMotion result;
  result.factors << seen.x(), -seen.y(), turned, swept,  //
      seen.y(), seen.x(), -swept, turned;
  result.base = motion.base.translation.head<2>();
  result.way = result.base.norm();
  return result;
}

std::vector<PlanarMotion> planar(const std::vector<MotionPair>& motions, const Eigen::Quaterniond& level_from_body) {
  std::vector<PlanarMotion> result;
  for (const MotionPair& motion : motions) result.push_back(planar(motion, level_from_body));
  return result;
}

// Metres, measured by wheels.
double way_of(const std::vector<PlanarMotion>& motions) {
  double way = 0.0;
  for (const PlanarMotion& motion : motions) way += motion.way;
  return way;
}

// Prior of the unknowns.
struct KnownUnknowns {
  Vector4 values = Vector4::Zero();
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  double translation_error = 0.0;
};

KnownUnknowns known_unknowns(const std::optional<WheelCalibration>& known, const Eigen::Vector3d& up) {
  if (!known) return {};
  const Eigen::Matrix4d covariance = known->covariance + day_to_day_covariance(*known);
  return {constrained_parameters(*known, up), covariance.ldlt().solve(Eigen::Matrix4d::Identity()),
          known->translation_error};
}

struct Solution {
  Vector4 unknowns = Vector4::Zero();
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();
  double translation_error = 0.0;
};

double deviation(const PlanarMotion& motion, const Vector4& unknowns) {
  constexpr double kNoise = 0.005;  // metres
  return (motion.factors * unknowns - motion.base).norm() / (motion.way + kNoise);
}

// Iteratively reweighted least squares with Geman-McClure weights.
std::optional<Solution> solve(const std::vector<PlanarMotion>& motions, const KnownUnknowns& known) {
  constexpr double kLeastShare = 0.01;  // share of the path length: limit of the wheels' accuracy
  constexpr double kNoise = 0.005;      // metres
  std::vector<double> weights(motions.size(), 1.0);
  Solution solution;
  double usual = std::max(known.translation_error, kLeastShare);
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d normal = 1e-9 * Eigen::Matrix4d::Identity() + usual * usual * known.information;
    Vector4 right = usual * usual * known.information * known.values;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const double weight = weights[i] / std::pow(motions[i].way + kNoise, 2);
      normal += weight * motions[i].factors.transpose() * motions[i].factors;
      right += weight * motions[i].factors.transpose() * motions[i].base;
    }
    const Eigen::LDLT<Eigen::Matrix4d> factored(normal);
    if (factored.info() != Eigen::Success) return {};
    solution.unknowns = factored.solve(right);
    std::vector<double> errors;
    for (const PlanarMotion& motion : motions) errors.push_back(deviation(motion, solution.unknowns));
    solution.translation_error = median_or(errors, known.translation_error > 0.0 ? known.translation_error : 1.0);
    usual = std::max(solution.translation_error, kLeastShare);
    for (std::size_t i = 0; i < motions.size(); ++i) {
      weights[i] = 1.0 / std::pow(1.0 + std::pow(errors[i] / (3.0 * usual), 2), 2);
    }
    solution.covariance = usual * usual * factored.solve(Eigen::Matrix4d::Identity());
  }
  return solution;
}

// Up axis from a prior and the turns of the body, made perpendicular to the driving direction.
std::optional<Eigen::Vector3d> initial_up(const std::vector<MotionPair>& motions, const Eigen::Vector3d& up_in_body,
                                          UpSource source) {
  constexpr double kPresumed = 0.05;  // weight of an assumed axis, sum of squared turns
  constexpr double kMeasured = 1.0;   // weight of an axis from an accelerometer, sum of squared turns
  constexpr double kTurning = 0.1;    // radians; larger turns blur the driving direction
  constexpr double kLeast = 0.3;      // relative length of the axis after the projection
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero(), left = ahead,
                  turned = (source == UpSource::measured ? kMeasured : kPresumed) * up_in_body.normalized();
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(motion.base);
    const Eigen::Vector3d seen = motion.body.translation / (1.0 + std::pow(yaw / kTurning, 2));
    ahead += motion.base.translation.x() * seen;
    left += motion.base.translation.y() * seen;
    turned += yaw * rotation_log(motion.body.rotation);
  }
  const Eigen::Vector3d level = (ahead.norm() >= left.norm() ? ahead : left).normalized();
  if (!(level.norm() > 0.0)) return {};
  const Eigen::Vector3d up = turned - level * level.dot(turned);
  return up.norm() > kLeast * turned.norm() ? std::optional(up.normalized()) : std::nullopt;
}

double median_turn_error(const std::vector<MotionPair>& motions, const Eigen::Vector3d& up) {
  constexpr double kSmall = 0.05;  // radians
  std::vector<double> errors;
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(motion.base);
    if (std::abs(yaw) > kSmall) errors.push_back(std::abs(rotation_log(motion.body.rotation).dot(up) / yaw - 1.0));
  }
  return median_or(std::move(errors), 0.0);
}

// Relative error of sideways motion measured by wheels, from the motions that went sideways.
double lateral_error_of(const std::vector<MotionPair>& motions, const WheelCalibration& calibration) {
  constexpr double kSideways = 0.3;   // share of the path length
  constexpr double kShortWay = 0.02;  // metres
  constexpr std::size_t kLeast = 4;   // motions
  std::vector<double> errors;
  for (const MotionPair& motion : motions) {
    const double way = motion.base.translation.norm(), side = std::abs(lateral_displacement(motion.base));
    if (way < kShortWay || side < kSideways * way) continue;
    const Pose measured = body_motion(calibration, motion.base);
    errors.push_back(calibration.metres_per_unit * (measured.translation - motion.body.translation).norm() / side);
  }
  return errors.size() < kLeast ? WheelCalibration{}.lateral_error : median_or(std::move(errors), 0.0);
}

// Without the members that turns determine. Empty if the standard deviation of scale (relative) or direction (radians)
// exceeds max_sigma.
std::optional<WheelCalibration> calibration_from_solution(const Solution& solved,
                                                          const Eigen::Quaterniond& level_from_body, double max_sigma) {
  const double scale = solved.unknowns.head<2>().norm();
  if (!(scale > 0.0)) return {};
  const Eigen::Vector2d along = solved.unknowns.head<2>() / scale, across(-along.y(), along.x());
  const Eigen::Matrix2d covariance = solved.covariance.topLeftCorner<2, 2>() / (scale * scale);
  const double scale_sigma = std::sqrt(along.dot(covariance * along));
  const double direction_sigma = std::sqrt(across.dot(covariance * across));
  if (!(scale_sigma < max_sigma) || !(direction_sigma < max_sigma)) return {};
  const double angle = std::atan2(along.y(), along.x());
  WheelCalibration calibration;
  calibration.base_from_body.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())) * level_from_body;
  calibration.base_from_body.translation = {solved.unknowns[2], solved.unknowns[3], 0.0};
  calibration.metres_per_unit = scale;
  calibration.scale_sigma = scale_sigma;
  calibration.translation_error = solved.translation_error;
  calibration.covariance = solved.covariance;
  return calibration;
}

}  // namespace

Eigen::Vector4d constrained_parameters(const WheelCalibration& calibration, const Eigen::Vector3d& up_in_body) {
  const Eigen::Quaterniond level_from_body = rotation_between(up_in_body, Eigen::Vector3d::UnitZ());
  const double angle = rotation_log(calibration.base_from_body.rotation * level_from_body.conjugate()).z();
  const Eigen::Vector3d& arm = calibration.base_from_body.translation;
  return {calibration.metres_per_unit * std::cos(angle), calibration.metres_per_unit * std::sin(angle), arm.x(),
          arm.y()};
}

Eigen::Matrix4d day_to_day_covariance(const WheelCalibration& calibration) {
  constexpr double kShare = 0.007;  // relative for the scale, radians for the direction
  constexpr double kArm = 0.01;     // metres
  const double scale = kShare * calibration.metres_per_unit;
  return Vector4(scale * scale, scale * scale, kArm * kArm, kArm * kArm).asDiagonal();
}

std::optional<WheelCalibration> estimate_wheel_calibration(const std::vector<MotionPair>& measured,
                                                           const std::optional<WheelCalibration>& known) {
  const auto up = find_up(measured, known);
  if (!up) return {};
  const TurnErrors turn_errors = find_turn_errors(measured, *up, known);
  std::vector<MotionPair> motions = measured;
  for (MotionPair& motion : motions) motion.base = without_turn_errors(turn_errors, motion.base);
  const Eigen::Quaterniond level_from_body = rotation_between(*up, Eigen::Vector3d::UnitZ());
  const std::vector<PlanarMotion> planar_motions = planar(motions, level_from_body);
  if (way_of(planar_motions) < kLeastWay && !known) return {};
  const auto solved = solve(planar_motions, known_unknowns(known, *up));
  if (!solved) return {};
  auto calibration = calibration_from_solution(*solved, level_from_body, kMaxSigma);
  if (!calibration) return {};
  calibration->rotation_error = median_turn_error(motions, *up);
  calibration->turn_errors = turn_errors;
  calibration->lateral_error = lateral_error_of(motions, *calibration);
  return calibration;
}

std::optional<WheelCalibration> estimate_initial_wheel_calibration(const std::vector<MotionPair>& motions,
                                                                   const Eigen::Vector3d& up_in_body, UpSource source) {
  constexpr double kArm = 0.3;         // metres, standard deviation
  constexpr double kLeastWay = 0.3;    // metres, sum of all paths
  constexpr double kMaxSigma = 0.2;    // relative for the scale, radians for the direction
  constexpr double kLeastError = 0.1;  // share of path lengths and turns
  const auto up = initial_up(motions, up_in_body, source);
  if (!up) return {};
  const Eigen::Quaterniond level_from_body = rotation_between(*up, Eigen::Vector3d::UnitZ());
  const std::vector<PlanarMotion> planar_motions = planar(motions, level_from_body);
  if (way_of(planar_motions) < kLeastWay) return {};
  KnownUnknowns assumed;
  assumed.information.diagonal().tail<2>().setConstant(1.0 / (kArm * kArm));
  const auto solved = solve(planar_motions, assumed);
  if (!solved) return {};
  auto calibration = calibration_from_solution(*solved, level_from_body, kMaxSigma);
  if (!calibration) return {};
  calibration->translation_error = std::max(calibration->translation_error, kLeastError);
  calibration->rotation_error = std::max(median_turn_error(motions, *up), kLeastError);
  return calibration;
}

std::optional<WheelCalibration> forward_facing_calibration(const Eigen::Vector3d& up_in_body,
                                                           const Eigen::Vector3d& ahead_in_body) {
  constexpr double kArm = 0.3;         // metres, standard deviation
  constexpr double kLeastLevel = 0.5;  // sine of the angle between the two axes
  constexpr double kTurnError = 0.3;   // share of turns, because the body may be tilted
  const Eigen::Vector3d up = up_in_body.normalized();
  const Eigen::Vector3d level = ahead_in_body.normalized() - up * up.dot(ahead_in_body.normalized());
  if (level.norm() < kLeastLevel) return {};
  Eigen::Matrix3d base_from_body;
  base_from_body << level.normalized().transpose(), up.cross(level.normalized()).transpose(), up.transpose();
  WheelCalibration calibration;
  calibration.base_from_body.rotation = Eigen::Quaterniond(base_from_body);
  calibration.translation_error = 1.0;
  calibration.rotation_error = kTurnError;
  calibration.covariance.bottomRightCorner<2, 2>().diagonal().setConstant(kArm * kArm);
  return calibration;
}

Pose without_turn_errors(const TurnErrors& errors, const Pose& base) {
  const double extra = (errors.scale - 1.0) * yaw_of(base) + errors.per_metre * base.translation.x();
  const Eigen::Quaterniond half = rotation_exp({0.0, 0.0, 0.5 * extra});
  return {half * base.rotation * half, half * base.translation};
}

double lateral_displacement(const Pose& base) {
  const Eigen::Quaterniond half = rotation_exp(0.5 * rotation_log(base.rotation));
  return (half.conjugate() * base.translation).y();
}

Pose body_motion(const WheelCalibration& calibration, const Pose& base) {
  Pose motion = inverse(calibration.base_from_body) * base * calibration.base_from_body;
  motion.translation /= calibration.metres_per_unit;
  return motion;
}

}  // namespace byre
