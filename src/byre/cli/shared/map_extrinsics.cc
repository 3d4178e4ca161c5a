#include "byre/cli/shared/map_extrinsics.h"

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
  const WheelCalibration prior = as_prior(wheels);
  const double metres = std::sqrt(std::max(prior.covariance(3, 3), prior.covariance(4, 4)));
  return {metres, std::max(prior.tilt_sigma(), prior.heading_sigma()), prior.scale_sigma()};
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
    extrinsics.wheel_scale_sigma = sigmas.scale;
  }
  if (known.time_offset != 0.0) extrinsics.wheel_delay = known.time_offset;  // zero until it is estimated
  return extrinsics;
}

}  // namespace byre::cli
