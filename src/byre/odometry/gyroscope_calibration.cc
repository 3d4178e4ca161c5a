#include "byre/odometry/gyroscope_calibration.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/median.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/LU>

namespace byre {
namespace {

using namespace std::chrono_literals;

constexpr double kLeastTurned = 0.5;  // radians, sum of all turns
constexpr double kMaxError = 0.15;    // radians per second, median
constexpr Timestamp kBiasSpan = 30s;  // before the last tracked motion
constexpr int kMountingRounds = 4;

struct TurnPair {
  Eigen::Vector3d seen;      // radians, about the body's axes
  Eigen::Vector3d measured;  // radians, about the gyroscope's axes, with the bias
  double seconds = 0.0;
  bool is_recent = false;
};

std::vector<TurnPair> pairs_of(const std::deque<VisualMotion>& seen) {
  std::vector<TurnPair> pairs;
  for (const VisualMotion& motion : seen) {
    if (!motion.gyroscope_turn) continue;
    pairs.push_back({rotation_log(motion.body.rotation), *motion.gyroscope_turn,
                     to_seconds(motion.later - motion.earlier), motion.later + kBiasSpan >= seen.back().later});
  }
  return pairs;
}

// Least squares over all pairs (Kabsch 1976).
Eigen::Quaterniond rotation_of(const std::vector<TurnPair>& pairs, const Eigen::Vector3d& bias,
                               const std::optional<GyroscopeCalibration>& known) {
  constexpr double kKnown = 4.0;  // weight of the prior: sum of squared turns, about each axis
  Eigen::Matrix3d sum = 1e-12 * Eigen::Matrix3d::Identity();
  if (known) sum = kKnown * known->body_from_gyroscope.toRotationMatrix();
  for (const TurnPair& pair : pairs) sum += pair.seen * (pair.measured - bias * pair.seconds).transpose();
  return nearest_rotation(sum);
}

Eigen::Vector3d bias_of(const std::vector<TurnPair>& pairs, const Eigen::Quaterniond& body_from_gyroscope) {
  std::array<std::vector<double>, 3> rates;
  for (const TurnPair& pair : pairs) {
    if (!pair.is_recent) continue;
    const Eigen::Vector3d rate = (pair.measured - body_from_gyroscope.conjugate() * pair.seen) / pair.seconds;
    for (int axis = 0; axis < 3; ++axis) rates[static_cast<std::size_t>(axis)].push_back(rate[axis]);
  }
  Eigen::Vector3d bias;
  for (int axis = 0; axis < 3; ++axis) bias[axis] = median_or(std::move(rates[static_cast<std::size_t>(axis)]), 0.0);
  return bias;
}

// Covariance of the rotation. Errors of neighbouring turns are correlated.
Eigen::Matrix3d covariance_of(const std::vector<TurnPair>& pairs, double error,
                              const std::optional<GyroscopeCalibration>& known) {
  constexpr double kLeastError = 0.005;   // radians per second
  constexpr double kErringAlike = 4.0;    // factor of the variance for correlated errors
  constexpr double kLeastSigma = 0.003;   // radians, non-orthogonal axes of the sensor
  constexpr double kUsualChange = 0.005;  // radians, from day to day
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity() / GyroscopeCalibration::kOpenTurn;
  if (known) {
    information = (known->covariance + kUsualChange * kUsualChange * Eigen::Matrix3d::Identity()).inverse();
  }
  for (const TurnPair& pair : pairs) {
    const double sigma = std::max(error, kLeastError) * pair.seconds;
    const Eigen::Matrix3d across = skew(pair.seen);
    information += across.transpose() * across / (kErringAlike * sigma * sigma);
  }
  return information.inverse() + kLeastSigma * kLeastSigma * Eigen::Matrix3d::Identity();
}

}  // namespace

std::optional<GyroscopeCalibration> estimate_gyroscope_calibration(const std::deque<VisualMotion>& seen,
                                                                   const std::optional<GyroscopeCalibration>& known) {
  const std::size_t least_pairs = known ? 4 : 8;
  const std::vector<TurnPair> pairs = pairs_of(seen);
  double turned = 0.0;
  for (const TurnPair& pair : pairs) turned += pair.seen.norm();
  if (pairs.size() < least_pairs || (turned < kLeastTurned && !known)) return {};
  GyroscopeCalibration calibration;
  for (int round = 0; round < kMountingRounds; ++round) {
    calibration.body_from_gyroscope = rotation_of(pairs, calibration.bias, known);
    calibration.bias = bias_of(pairs, calibration.body_from_gyroscope);
  }
  std::vector<double> errors;
  for (const TurnPair& pair : pairs) {
    const Eigen::Vector3d measured =
        calibration.body_from_gyroscope * (pair.measured - calibration.bias * pair.seconds);
    errors.push_back((measured - pair.seen).norm() / pair.seconds);
  }
  calibration.error = median_or(std::move(errors), kMaxError);
  calibration.covariance = covariance_of(pairs, calibration.error, known);
  return calibration.error < kMaxError ? std::optional(calibration) : std::nullopt;
}

}  // namespace byre
