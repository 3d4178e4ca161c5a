#include "byre/cli/shared/map_extrinsics.h"

#include "byre/input_error.h"
#include "byre/odometry/odometry_calibration.h"

#include <algorithm>
#include <cmath>

namespace byre::cli {

Extrinsics extrinsics_of(const StoredMap& stored, const std::string& place) {
  const OdometryCalibration known = read_odometry_calibration(stored.notes);
  if (!known.wheels || stored.recordings.empty()) {
    throw InputError(place, "has no calibration of wheels", "map a recording with wheel odometry that turns both ways");
  }
  // Standard deviations for the next drive: with the usual change from day to day.
  const WheelCalibration prior = as_prior(*known.wheels);
  const double metres = std::sqrt(std::max(prior.covariance(3, 3), prior.covariance(4, 4)));
  const double radians = std::max(prior.tilt_sigma(), prior.heading_sigma());
  Extrinsics extrinsics;
  extrinsics.camera = SensorMounting{
      known.wheels->base_from_body * stored.recordings.front().calibration.body_from_left, metres, radians};
  if (stored.scale == MapScale::metric && !stored.notes.contains(kMetresNote)) {
    extrinsics.wheel_scale = 1.0 / known.wheels->metres_per_unit;
    extrinsics.wheel_scale_sigma = prior.scale_sigma();
  }
  if (known.time_offset != 0.0) extrinsics.wheel_delay = known.time_offset;  // zero until it is estimated
  return extrinsics;
}

}  // namespace byre::cli
