#pragma once

#include "byre/body_motion.h"
#include "byre/motion_warning.h"
#include "byre/recording.h"

#include <filesystem>
#include <string>

namespace byre {

// What wheels and a gyroscope recorded beside the images of a folder:
//   wheel.txt               poses of the base in the wheels' own frame, "time_s tx ty tz qx qy qz qw" (TUM)
//   mav0/imu0/data.csv      EuRoC: time in nanoseconds, angular rates in radians per second, and accelerations in m/s^2
//                           where there are some
//   mav0/imu0/sensor.yaml   EuRoC: how the sensor is turned against the body (T_BS)
// Wheels are used where the file is there or the options name one; the gyroscope where the options ask for it. Throws
// InputError naming file and line: a file named is not there, or does not parse, or has times out of order.
// body_from_left: of the recording's own calibration.
MotionSamples read_motion(const std::filesystem::path& recording, const OpenOptions& options,
                          const Pose& body_from_left = {});

// File or topic that a sensor's samples were read from.
std::string motion_source(const std::filesystem::path& recording, const OpenOptions& options, MotionSensor sensor);

}  // namespace byre
