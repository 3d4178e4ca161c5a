#include "byre/odometry/odometry_calibration.h"

#include "byre/alignment.h"
#include "byre/base/numbers_by_name.h"
#include "byre/geometry/decompositions.h"

#include <array>
#include <cmath>
#include <span>

#include <Eigen/Cholesky>
#include <fmt/format.h>

namespace byre {
namespace {

constexpr const char* kWheels = "wheels";
constexpr const char* kGyroscope = "gyroscope";
constexpr const char* kGravity = "gravity";
constexpr double kNeglected = 9.0;  // factor of the variances of an estimate for errors that motions have in common

void add_rotation(NumbersByName& numbers, const std::string& name, const Eigen::Quaterniond& rotation) {
  numbers.add(name, std::array{rotation.w(), rotation.x(), rotation.y(), rotation.z()});
}

bool get_rotation(const NumbersByName& numbers, const std::string& name, Eigen::Quaterniond& rotation) {
  constexpr double kUnit = 1e-3;
  std::array<double, 4> values{};
  if (!numbers.get(name, values)) return false;
  const Eigen::Quaterniond read(values[0], values[1], values[2], values[3]);
  if (!(std::abs(read.norm() - 1.0) < kUnit)) return false;
  rotation = read.normalized();
  return true;
}

std::string note_of(const WheelCalibration& wheels, double time_offset) {
  NumbersByName numbers;
  add_rotation(numbers, "base_from_body_wxyz", wheels.base_from_body.rotation);
  numbers.add("arm_m", std::span(wheels.base_from_body.translation.data(), 3));
  numbers.add("metres_per_unit", wheels.metres_per_unit);
  numbers.add("way_error", wheels.translation_error);
  numbers.add("turn_error", wheels.rotation_error);
  numbers.add("turn_scale", wheels.turn_errors.scale);
  numbers.add("turn_per_metre", wheels.turn_errors.per_metre);
  numbers.add("covariance", std::span(wheels.covariance.data(), wheels.covariance.size()));
  numbers.add("delay_s", time_offset);
  return numbers.text();
}

// Older versions have the covariance of metres_per_unit times cosine and sine of the heading, and of the lever arm, and
// no sigma of the other parameters.
bool read_older_covariance(const NumbersByName& numbers, WheelCalibration& wheels) {
  Eigen::Matrix4d older;
  if (!numbers.get("covariance", std::span(older.data(), 16))) return false;
  const Eigen::Quaterniond level_from_body = rotation_between(wheels.up_in_body(), Eigen::Vector3d::UnitZ());
  const double heading = rotation_log(wheels.base_from_body.rotation * level_from_body.conjugate()).z();
  const Eigen::Vector2d along = Eigen::Vector2d(std::cos(heading), std::sin(heading)) / wheels.metres_per_unit;
  Eigen::Matrix<double, 9, 4> factors = Eigen::Matrix<double, 9, 4>::Zero();
  factors.block<1, 2>(2, 0) << -along.y(), along.x();
  factors.block<2, 2>(3, 2).setIdentity();
  factors.block<1, 2>(6, 0) = along.transpose();
  wheels.covariance = day_to_day_covariance() + factors * older * factors.transpose();
  return true;
}

bool read_note(const NumbersByName& numbers, WheelCalibration& wheels, double& time_offset) {
  Eigen::Vector3d& arm = wheels.base_from_body.translation;
  const bool has_mean =
      get_rotation(numbers, "base_from_body_wxyz", wheels.base_from_body.rotation) &&
      (numbers.get("arm_m", std::span(arm.data(), 3)) || numbers.get("arm_m", std::span(arm.data(), 2))) &&
      numbers.get("metres_per_unit", wheels.metres_per_unit) && wheels.metres_per_unit > 0.0 &&
      numbers.get("way_error", wheels.translation_error) && numbers.get("turn_error", wheels.rotation_error) &&
      numbers.get("turn_scale", wheels.turn_errors.scale) &&
      numbers.get("turn_per_metre", wheels.turn_errors.per_metre) && numbers.get("delay_s", time_offset);
  if (!has_mean) return false;
  WheelCovariance& covariance = wheels.covariance;
  const bool has_covariance =
      numbers.get("covariance", std::span(covariance.data(), static_cast<std::size_t>(covariance.size()))) ||
      read_older_covariance(numbers, wheels);
  return has_covariance && covariance.ldlt().isPositive() && covariance.isApprox(covariance.transpose());
}

}  // namespace

void write_odometry_calibration(const OdometryCalibration& calibration, std::map<std::string, std::string>& notes) {
  if (calibration.wheels) notes[kWheels] = note_of(*calibration.wheels, calibration.time_offset);
  if (calibration.up) {
    NumbersByName numbers;
    numbers.add("up_in_map", std::span(calibration.up->up_in_map.data(), 3));
    numbers.add("sigma_rad", calibration.up->sigma);
    notes[kGravity] = numbers.text();
  }
  if (!calibration.gyroscope) return;
  NumbersByName numbers;
  add_rotation(numbers, "body_from_gyroscope_wxyz", calibration.gyroscope->body_from_gyroscope);
  numbers.add("error_rad_per_s", calibration.gyroscope->error);
  numbers.add("covariance", std::span(calibration.gyroscope->covariance.data(), 9));
  notes[kGyroscope] = numbers.text();
}

OdometryCalibration read_odometry_calibration(const std::map<std::string, std::string>& notes) {
  OdometryCalibration calibration;
  if (const auto note = notes.find(kWheels); note != notes.end()) {
    WheelCalibration wheels;
    double time_offset = 0.0;
    if (read_note(NumbersByName(note->second), wheels, time_offset)) {
      calibration.wheels = wheels;
      calibration.time_offset = time_offset;
    }
  }
  if (const auto note = notes.find(kGyroscope); note != notes.end()) {
    GyroscopeCalibration gyroscope;
    const NumbersByName numbers(note->second);
    if (get_rotation(numbers, "body_from_gyroscope_wxyz", gyroscope.body_from_gyroscope) &&
        numbers.get("error_rad_per_s", gyroscope.error)) {
      Eigen::Matrix3d covariance;  // missing in notes of older versions
      const bool is_noted = numbers.get("covariance", std::span(covariance.data(), 9));
      if (is_noted && covariance.ldlt().isPositive() && covariance.isApprox(covariance.transpose())) {
        gyroscope.covariance = covariance;
      }
      calibration.gyroscope = gyroscope;
    }
  }
  if (const auto note = notes.find(kGravity); note != notes.end()) {
    UpInMap up;
    const NumbersByName numbers(note->second);
    const bool is_whole =
        numbers.get("up_in_map", std::span(up.up_in_map.data(), 3)) && numbers.get("sigma_rad", up.sigma);
    if (is_whole && std::abs(up.up_in_map.norm() - 1.0) < 1e-3 && up.sigma > 0.0) calibration.up = up;
  }
  return calibration;
}

OdometryCalibration scaled(OdometryCalibration calibration, double factor) {
  if (calibration.wheels) calibration.wheels->metres_per_unit /= factor;
  return calibration;
}

OdometryCalibration moved(OdometryCalibration calibration, const Pose& before_from_after) {
  if (calibration.wheels) {
    WheelCalibration& wheels = *calibration.wheels;
    const Pose arm = scale_lengths(before_from_after, wheels.metres_per_unit);
    const Eigen::Vector3d shift = wheels.base_from_body.rotation * arm.translation;
    WheelCovariance factors = WheelCovariance::Identity();
    factors.block<3, 3>(3, 0) = -skew(shift);
    factors.block<3, 1>(3, 6) = shift;
    wheels.covariance = factors * wheels.covariance * factors.transpose();
    wheels.base_from_body = wheels.base_from_body * arm;
  }
  if (calibration.gyroscope) {
    Eigen::Quaterniond& turned = calibration.gyroscope->body_from_gyroscope;
    turned = before_from_after.rotation.conjugate() * turned;
    Eigen::Matrix3d& covariance = calibration.gyroscope->covariance;
    const Eigen::Matrix3d after_from_before = before_from_after.rotation.conjugate().toRotationMatrix();
    covariance = after_from_before * covariance * after_from_before.transpose();
  }
  return calibration;
}

WheelCalibration as_prior(WheelCalibration earlier) {
  earlier.covariance = kNeglected * earlier.covariance + day_to_day_covariance();
  return earlier;
}

bool is_contradicted(const WheelCalibration& prior, const WheelCalibration& found) {
  constexpr double kMostSquaredSigmas = 27.9;  // sum over nine parameters; probability 1/1000 to exceed it
  const WheelDeviation apart = difference(prior, found);
  const WheelCovariance covariance = prior.covariance + kNeglected * found.covariance;
  return apart.dot(covariance.ldlt().solve(apart)) > kMostSquaredSigmas;
}

std::string metres_note(double sigma) {
  return fmt::format("sigma_by_wheels {:.4f}", sigma);
}

}  // namespace byre
