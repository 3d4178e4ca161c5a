#include "byre/odometry/wheel_calibration.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

namespace byre {
namespace {

constexpr int kRounds = 8;              // rounds of reweighting
constexpr double kMaxAxisError = 0.35;  // radians, median angle between the axes of turns in images
constexpr double kNoise = 0.005;        // metres, of a motion by images and ticks of encoders
constexpr double kWide = 0.5;           // radians or natural logarithm; a wider prior does not give a start value
constexpr double kFlat = 10.0;          // standard deviation of an unknown rotation (radians) or scale (logarithm)

using Vector4 = Eigen::Vector4d;

double yaw_of(const Pose& base) {
  return rotation_log(base.rotation).z();
}

// Length of a motion by wheels to which its errors are proportional, metres.
double length_of(const Pose& base) {
  constexpr double kRadius = 0.2;  // metres; turns displace sensors and let wheels slide by a share of this arc
  return base.translation.norm() + kRadius * std::abs(yaw_of(base)) + kNoise;
}

double geman_mcclure(double error, double usual) {
  return 1.0 / std::pow(1.0 + std::pow(error / (3.0 * usual), 2), 2);
}

WheelCovariance covariance_of(double tilt, double heading, double arm, double height, double scale) {
  constexpr double kTurnScale = 0.03;      // share, among wheels
  constexpr double kTurnPerMetre = 0.005;  // radians per metre, among wheels
  WheelDeviation sigmas;
  sigmas << tilt, tilt, heading, arm, arm, height, scale, kTurnScale, kTurnPerMetre;
  return sigmas.cwiseAbs2().asDiagonal();
}

WheelCalibration deviated(WheelCalibration calibration, const WheelDeviation& by) {
  Pose& pose = calibration.base_from_body;
  pose.rotation = (rotation_exp(by.head<3>()) * pose.rotation).normalized();
  pose.translation += by.segment<3>(3);
  calibration.metres_per_unit *= std::exp(by[6]);
  calibration.turn_errors.scale += by[7];
  calibration.turn_errors.per_metre += by[8];
  return calibration;
}

// The base's up axis in the body by the prior and by turns. With an approximate prior it is made perpendicular to the
// driving direction. Empty if neither determines it.
std::optional<Eigen::Vector3d> initial_up(const std::vector<MotionPair>& motions, const WheelCalibration& prior) {
  constexpr double kTurnSigma = 0.02;  // radians, of a turn about the other axes
  constexpr double kTurning = 0.1;     // radians; larger turns blur the driving direction
  constexpr double kLeast = 0.3;       // relative length of the axis after the projection
  const double tilt = prior.tilt_sigma();
  Eigen::Vector3d ahead = Eigen::Vector3d::Zero(), left = ahead,
                  turned = std::pow(kTurnSigma / tilt, 2) * prior.up_in_body();
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(motion.base);
    const Eigen::Vector3d seen = motion.body.translation / (1.0 + std::pow(yaw / kTurning, 2));
    ahead += motion.base.translation.x() * seen;
    left += motion.base.translation.y() * seen;
    turned += yaw * rotation_log(motion.body.rotation);
  }
  if (tilt > kWide) return turned.norm() > std::pow(kTurnSigma, 2) ? std::optional(turned.normalized()) : std::nullopt;
  const Eigen::Vector3d level = (ahead.norm() >= left.norm() ? ahead : left).normalized();
  if (!(level.norm() > 0.0)) return {};
  const Eigen::Vector3d up = turned - level * level.dot(turned);
  return up.norm() > kLeast * turned.norm() ? std::optional(up.normalized()) : std::nullopt;
}

// Robust linear least squares for the pose on the base and the scale, with the up axis in the body given. A motion is
// two equations in metres, linear in (s cos, s sin, x, y): s metres per unit of the map, the angle from the levelled
// body to the base, and x and y the lever arm.
std::optional<WheelCalibration> planar_solution(const std::vector<MotionPair>& motions, const Eigen::Vector3d& up,
                                                WheelCalibration prior) {
  constexpr double kLeastShare = 0.01;  // share of the path length: limit of the wheels' accuracy
  const Eigen::Quaterniond level_from_body = rotation_between(up, Eigen::Vector3d::UnitZ());
  const double by_prior = 1.0 / prior.covariance.block<2, 2>(3, 3).diagonal().maxCoeff();
  std::vector<double> weights(motions.size(), 1.0);
  Vector4 solved = Vector4::Zero();
  double usual = kLeastShare;
  for (int round = 0; round < kRounds; ++round) {
    Eigen::Matrix4d normal = 1e-9 * Eigen::Matrix4d::Identity();
    normal.diagonal().tail<2>().array() += usual * usual * by_prior;
    Vector4 right = Vector4::Zero();
    right.tail<2>() = usual * usual * by_prior * prior.base_from_body.translation.head<2>();
    std::vector<double> errors;
    for (std::size_t i = 0; i < motions.size(); ++i) {
      const double yaw = yaw_of(motions[i].base), turned = 1.0 - std::cos(yaw), swept = std::sin(yaw);
      const Eigen::Vector3d seen = level_from_body * motions[i].body.translation;
      Eigen::Matrix<double, 2, 4> factors;
      factors << seen.x(), -seen.y(), turned, swept,  //
          seen.y(), seen.x(), -swept, turned;
      const Eigen::Vector2d base = motions[i].base.translation.head<2>();
      const double length = length_of(motions[i].base);
      errors.push_back((factors * solved - base).norm() / length);
      if (round > 0) weights[i] = geman_mcclure(errors.back(), usual);
      const double weight = weights[i] / (length * length);
      normal += weight * factors.transpose() * factors;
      right += weight * factors.transpose() * base;
    }
    if (round > 0) usual = std::max(median_or(std::move(errors), usual), kLeastShare);
    const Eigen::LDLT<Eigen::Matrix4d> factored(normal);
    if (factored.info() != Eigen::Success) return {};
    solved = factored.solve(right);
  }
  const double scale = solved.head<2>().norm();
  if (!(scale > 0.0) || !solved.allFinite()) return {};
  const double angle = std::atan2(solved[1], solved[0]);
  prior.base_from_body.rotation =
      Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())) * level_from_body;
  prior.base_from_body.translation.head<2>() = solved.tail<2>();
  prior.metres_per_unit = scale;
  return prior;
}

// Median ratio of the path of wheels to that of images; that of the prior without motions.
double scale_by_lengths(const std::vector<MotionPair>& motions, const WheelCalibration& prior) {
  std::vector<double> scales;
  for (const MotionPair& motion : motions) {
    const Eigen::Vector3d& arm = prior.base_from_body.translation;
    const double way = (motion.base.translation + motion.base.rotation * arm - arm).norm();
    const double seen = motion.body.translation.norm();
    if (way > kNoise && seen > 0.0) scales.push_back(way / seen);
  }
  return median_or(std::move(scales), prior.metres_per_unit);
}

// Where Gauss-Newton begins: the prior in what it determines, otherwise the linear solution.
std::optional<WheelCalibration> start_of(const std::vector<MotionPair>& motions, const WheelCalibration& prior) {
  if (prior.tilt_sigma() < kWide && prior.heading_sigma() < kWide) {
    WheelCalibration start = prior;
    if (prior.scale_sigma() > kWide) start.metres_per_unit = scale_by_lengths(motions, prior);
    return start;
  }
  const auto up = initial_up(motions, prior);
  return up ? planar_solution(motions, *up, prior) : std::nullopt;
}

// The prior with its mean moved to the start in the directions that it leaves open, in which its logarithm would be
// distorted far from the mean.
WheelCalibration centred(const WheelCalibration& prior, const WheelCalibration& start) {
  WheelCalibration result = prior;
  if (prior.tilt_sigma() > kWide) {
    result.base_from_body.rotation = start.base_from_body.rotation;
  } else if (prior.heading_sigma() > kWide) {
    const Eigen::Quaterniond turn = start.base_from_body.rotation * prior.base_from_body.rotation.conjugate();
    const double angle = 2.0 * std::atan2(turn.z(), turn.w());  // the turn about the up axis alone
    result.base_from_body.rotation = rotation_exp({0.0, 0.0, angle}) * prior.base_from_body.rotation;
  }
  if (prior.scale_sigma() > kWide) result.metres_per_unit = start.metres_per_unit;
  return result;
}

// Differences of a motion by images from that by wheels, in axes of the base, with their derivatives. The derivatives
// are taken at the motion by wheels, whose noise is smaller: that of images would shrink the scale.
struct Residual {
  Eigen::Matrix<double, 6, 1> values;  // rotation (radians), translation (metres)
  Eigen::Matrix<double, 6, 9> factors;
  double length = 0.0;  // see length_of
};

Residual residual_of(const MotionPair& motion, const WheelCalibration& calibration) {
  const Eigen::Quaterniond& rotation = calibration.base_from_body.rotation;
  const Eigen::Vector3d& arm = calibration.base_from_body.translation;
  const Pose base = without_turn_errors(calibration.turn_errors, motion.base);
  const Eigen::Vector2d turn_factors(yaw_of(motion.base), motion.base.translation.x());
  const Eigen::Vector3d seen = calibration.metres_per_unit * (rotation * motion.body.translation);
  const Eigen::Quaterniond turn = rotation * motion.body.rotation * rotation.conjugate();
  const Eigen::Matrix3d turned = base.rotation.toRotationMatrix();
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d predicted = base.translation + turned * arm - arm;
  Residual result;
  result.values << rotation_log(turn * base.rotation.conjugate()), seen - predicted;
  result.factors.setZero();
  result.factors.topLeftCorner<3, 3>() = Eigen::Matrix3d::Identity() - turn.toRotationMatrix();
  result.factors.block<1, 2>(2, 7) = -turn_factors.transpose();
  result.factors.bottomLeftCorner<3, 3>() = -skew(predicted);
  result.factors.block<3, 3>(3, 3) = Eigen::Matrix3d::Identity() - turned;
  result.factors.block<3, 1>(3, 6) = predicted;
  result.factors.block<3, 2>(3, 7) = -up.cross(turned * arm + 0.5 * motion.base.translation) * turn_factors.transpose();
  result.length = length_of(motion.base);
  return result;
}

// Usual sizes of the differences.
struct UsualErrors {
  double yaw = 0.01;     // radians
  double tilt = 0.01;    // radians
  double plane = 0.01;   // share of the path length, in the driving plane
  double height = 0.02;  // share of the path length, across the plane
};

UsualErrors usual_errors_of(const std::vector<Residual>& residuals) {
  constexpr UsualErrors kLeast{0.001, 0.003, 0.01, 0.02};  // limits of the accuracy of images and wheels
  std::vector<double> yaws, tilts, planes, heights;
  for (const Residual& residual : residuals) {
    yaws.push_back(std::abs(residual.values[2]));
    tilts.push_back(residual.values.head<2>().norm());
    planes.push_back(residual.values.segment<2>(3).norm() / residual.length);
    heights.push_back(std::abs(residual.values[5]) / residual.length);
  }
  const UsualErrors unknown;
  return {std::max(median_or(std::move(yaws), unknown.yaw), kLeast.yaw),
          std::max(median_or(std::move(tilts), unknown.tilt), kLeast.tilt),
          std::max(median_or(std::move(planes), unknown.plane), kLeast.plane),
          std::max(median_or(std::move(heights), unknown.height), kLeast.height)};
}

// Weights of the six differences of a motion.
Eigen::Matrix<double, 6, 1> weights_of(const Residual& residual, const UsualErrors& usual) {
  const auto weight = [](double error, double sigma) { return geman_mcclure(error, sigma) / (sigma * sigma); };
  const double yaw = weight(residual.values[2], usual.yaw);
  const double tilt = weight(residual.values.head<2>().norm(), usual.tilt);
  const double plane = weight(residual.values.segment<2>(3).norm(), usual.plane * residual.length);
  const double height = weight(residual.values[5], usual.height * residual.length);
  Eigen::Matrix<double, 6, 1> weights;
  weights << tilt, tilt, yaw, plane, plane, height;
  return weights;
}

// Whether turns of wheels and images have a common axis, or none are large enough to compare.
bool have_common_axis(const std::vector<MotionPair>& motions, const WheelCalibration& calibration) {
  constexpr double kSmall = 0.03;  // radians, turns with a poorly determined axis
  std::vector<double> errors;
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(motion.base);
    if (std::abs(yaw) < kSmall) continue;
    errors.push_back((rotation_log(motion.body.rotation) / yaw - calibration.up_in_body()).norm());
  }
  return median_or(std::move(errors), 0.0) < kMaxAxisError;
}

double median_turn_error(const std::vector<MotionPair>& motions, const WheelCalibration& calibration) {
  constexpr double kSmall = 0.05;  // radians
  std::vector<double> errors;
  for (const MotionPair& motion : motions) {
    const double yaw = yaw_of(without_turn_errors(calibration.turn_errors, motion.base));
    if (std::abs(yaw) < kSmall) continue;
    errors.push_back(std::abs(rotation_log(motion.body.rotation).dot(calibration.up_in_body()) / yaw - 1.0));
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
    const Pose base = without_turn_errors(calibration.turn_errors, motion.base);
    const double way = base.translation.norm(), side = std::abs(lateral_displacement(base));
    if (way < kShortWay || side < kSideways * way) continue;
    const Pose measured = body_motion(calibration, base);
    errors.push_back(calibration.metres_per_unit * (measured.translation - motion.body.translation).norm() / side);
  }
  return errors.size() < kLeast ? WheelCalibration{}.lateral_error : median_or(std::move(errors), 0.0);
}

}  // namespace

double WheelCalibration::tilt_sigma() const {
  return std::sqrt(covariance.topLeftCorner<2, 2>().diagonal().maxCoeff());
}

double WheelCalibration::heading_sigma() const {
  return std::sqrt(covariance(2, 2));
}

double WheelCalibration::arm_sigma() const {
  return std::sqrt(covariance.block<2, 2>(3, 3).trace());
}

double WheelCalibration::scale_sigma() const {
  return std::sqrt(covariance(6, 6));
}

WheelDeviation difference(const WheelCalibration& from, const WheelCalibration& to) {
  WheelDeviation result;
  result << rotation_log(to.base_from_body.rotation * from.base_from_body.rotation.conjugate()),
      to.base_from_body.translation - from.base_from_body.translation,
      std::log(to.metres_per_unit / from.metres_per_unit), to.turn_errors.scale - from.turn_errors.scale,
      to.turn_errors.per_metre - from.turn_errors.per_metre;
  return result;
}

WheelCalibration with_unknown_scale(WheelCalibration calibration) {
  calibration.covariance.row(6).setZero();
  calibration.covariance.col(6).setZero();
  calibration.covariance(6, 6) = kFlat * kFlat;
  return calibration;
}

WheelCovariance day_to_day_covariance() {
  constexpr double kShare = 0.007;         // relative for the scale, radians for the rotation
  constexpr double kArm = 0.01;            // metres
  constexpr double kTurnScale = 0.005;     // share
  constexpr double kTurnPerMetre = 0.001;  // radians per metre
  WheelDeviation sigmas;
  sigmas << kShare, kShare, kShare, kArm, kArm, kArm, kShare, kTurnScale, kTurnPerMetre;
  return sigmas.cwiseAbs2().asDiagonal();
}

WheelCalibration unknown_wheel_calibration() {
  constexpr double kArm = 3.0;     // metres
  constexpr double kHeight = 1.0;  // metres, which the motions of a base in its plane do not determine
  WheelCalibration unknown;
  unknown.covariance = covariance_of(kFlat, kFlat, kArm, kHeight, kFlat);
  return unknown;
}

WheelCalibration upright_wheel_calibration(const Eigen::Vector3d& up_in_body, double tilt_sigma) {
  constexpr double kArm = 0.3;  // metres
  WheelCalibration upright;
  upright.base_from_body.rotation = rotation_between(up_in_body, Eigen::Vector3d::UnitZ());
  upright.covariance = covariance_of(tilt_sigma, kFlat, kArm, 1.0, kFlat);
  return upright;
}

std::optional<WheelCalibration> forward_facing_calibration(const Eigen::Vector3d& up_in_body,
                                                           const Eigen::Vector3d& ahead_in_body) {
  constexpr double kTilt = 0.3;        // radians
  constexpr double kHeading = 1.0;     // radians
  constexpr double kArm = 0.3;         // metres
  constexpr double kScale = 0.03;      // share, among wheels
  constexpr double kLeastLevel = 0.5;  // sine of the angle between the two axes
  const Eigen::Vector3d up = up_in_body.normalized();
  const Eigen::Vector3d level = ahead_in_body.normalized() - up * up.dot(ahead_in_body.normalized());
  if (level.norm() < kLeastLevel) return {};
  Eigen::Matrix3d base_from_body;
  base_from_body << level.normalized().transpose(), up.cross(level.normalized()).transpose(), up.transpose();
  WheelCalibration calibration;
  calibration.base_from_body.rotation = Eigen::Quaterniond(base_from_body);
  calibration.covariance = covariance_of(kTilt, kHeading, kArm, 1.0, kScale);
  return calibration;
}

std::optional<WheelCalibration> estimate_wheel_calibration(const std::vector<MotionPair>& motions,
                                                           const WheelCalibration& prior) {
  constexpr double kConverged = 1e-9;
  auto found = start_of(motions, prior);
  if (!found) return {};
  const WheelCalibration mean = centred(prior, *found);
  const WheelCovariance information = prior.covariance.ldlt().solve(WheelCovariance::Identity());
  UsualErrors usual;
  for (int round = 0; round < kRounds; ++round) {
    std::vector<Residual> residuals;
    for (const MotionPair& motion : motions) residuals.push_back(residual_of(motion, *found));
    usual = usual_errors_of(residuals);
    WheelCovariance normal = information;
    WheelDeviation right = information * difference(*found, mean);
    for (const Residual& residual : residuals) {
      const auto weighted = (residual.factors.transpose() * weights_of(residual, usual).asDiagonal()).eval();
      normal += weighted * residual.factors;
      right -= weighted * residual.values;
    }
    const Eigen::LDLT<WheelCovariance> factored(normal);
    if (factored.info() != Eigen::Success) return {};
    const WheelDeviation step = factored.solve(right);
    if (!step.allFinite()) return {};
    *found = deviated(*found, step);
    found->covariance = factored.solve(WheelCovariance::Identity());
    if (step.norm() < kConverged) break;
  }
  if (!have_common_axis(motions, *found)) return {};
  found->translation_error = motions.empty() ? prior.translation_error : usual.plane;
  found->rotation_error = median_turn_error(motions, *found);
  found->lateral_error = lateral_error_of(motions, *found);
  return found;
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
