#pragma once

#include "byre/map/map_file.h"
#include "byre/odometry/odometry_calibration.h"

#include <vector>

namespace byre {

// Mounting of wheels and gyroscope of a map, for the body of the given cameras. Empty if they made no recording of it.
OdometryCalibration odometry_calibration_for(const OdometryCalibration& of_map,
                                             const std::vector<SourceRecording>& recordings, const Calibration& given);

// Up axis of the robot's base in the body of a map's cameras, by the mounting kept with the map. Empty without one, if
// it is known to no better than 0.1 radians, or with recordings of several cameras.
std::optional<UpInBody> up_of_base(const OdometryCalibration& of_map, const std::vector<SourceRecording>& recordings);
std::optional<UpInBody> up_of_base(const StoredMap& stored);

}  // namespace byre
