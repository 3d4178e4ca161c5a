#pragma once

#include "byre/map/map_file.h"
#include "byre/odometry/odometry_calibration.h"

#include <vector>

namespace byre {

// Mounting of wheels and gyroscope of a map, for the body of the given cameras. Empty if they made no recording of it.
OdometryCalibration odometry_calibration_for(const OdometryCalibration& of_map,
                                             const std::vector<SourceRecording>& recordings, const Calibration& given);

}  // namespace byre
