#include "byre/cli/inspect/map_extrinsics.h"

#include "byre/input_error.h"
#include "byre/odometry/odometry_calibration.h"

#include <algorithm>
#include <cmath>

namespace byre::cli {
namespace {

struct WheelSigmas {
  double metres = 0.0;   // lever arm, each axis
  double radians = 0.0;  // rotation of the body on the base, about each axis
  double scale = 0.0;    // relative
};

// Standard deviations for the next drive: with the usual change from day to day.
WheelSigmas sigmas_of(const WheelCalibration& wheels) {
  constexpr double kTilt = 0.0175;  // radians, of the up axis, whose uncertainty the covariance does not have
  const Eigen::Vector3d up_in_body = wheels.base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ();
  const Eigen::Matrix4d covariance = wheels.covariance + day_to_day_covariance(wheels);
  const Eigen::Vector2d ahead = constrained_parameters(wheels, up_in_body).head<2>().normalized();
  const Eigen::Vector2d across(-ahead.y(), ahead.x());
  const auto relative = [&](const Eigen::Vector2d& direction) {
    return std::sqrt(direction.dot(covariance.topLeftCorner<2, 2>() * direction)) / wheels.metres_per_unit;
  };
  return {std::sqrt(std::max(covariance(2, 2), covariance(3, 3))), std::max(relative(across), kTilt), relative(ahead)};
}

}  // namespace

Extrinsics extrinsics_of(const StoredMap& stored, const std::string& place) {
  const OdometryCalibration known = read_odometry_calibration(stored.notes);
  if (!known.wheels || stored.recordings.empty()) {
    throw InputError(place, "has no calibration of wheels", "map a recording with wheel odometry that turns both ways");
  }
  const WheelSigmas sigmas = sigmas_of(*known.wheels);
  Extrinsics extrinsics;
  extrinsics.camera =
      SensorMounting{known.wheels->base_from_body * stored.recordings.front().calibration.body_from_left, sigmas.metres,
                     sigmas.radians};
  if (stored.scale == MapScale::metric && !stored.notes.contains(kMetresNote)) {
    extrinsics.wheel_scale = 1.0 / known.wheels->metres_per_unit;
    extrinsics.wheel_scale_sigma = std::hypot(sigmas.scale, known.wheels->scale_sigma);
  }
  if (known.time_offset != 0.0) extrinsics.wheel_delay = known.time_offset;  // zero until it is estimated
  return extrinsics;
}

}  // namespace byre::cli
