#pragma once

#include "byre/body_motion.h"
#include "byre/dataset/restored_times.h"
#include "byre/motion_warning.h"
#include "byre/recording.h"

#include <filesystem>
#include <string>
#include <vector>

namespace byre {

// What wheels and a gyroscope recorded beside the images of a folder:
//   wheel.txt               poses of the base in the wheels' own frame, "time_s tx ty tz qx qy qz qw" (TUM)
//   mav0/imu0/data.csv      EuRoC: time in nanoseconds, angular rates in radians per second, and accelerations in m/s^2
//                           where there are some
//   mav0/imu0/sensor.yaml   EuRoC: how the sensor is turned against the body (T_BS)
// Wheels are used where the file is there or the options name one; the gyroscope where the options ask for it. Throws
// InputError naming file and line: a file named is not there, or does not parse.
struct FileMotion {
  MotionSamples samples;
  std::vector<std::string> warnings;  // corrections of times and lines left out, with counts
};

// body_from_left: by the recording's own calibration. images: clock of the left images.
FileMotion read_motion(const std::filesystem::path& recording, const OpenOptions& options,
                       const Pose& body_from_left = {}, const SensorClock& images = {});

// Poses of a wheel file, with continuous times (restore_times).
Trajectory read_wheel_file(const std::filesystem::path& path, const SensorClock& images,
                           std::vector<std::string>& warnings);

// File or topic that a sensor's samples were read from.
std::string motion_source(const std::filesystem::path& recording, const OpenOptions& options, MotionSensor sensor);

}  // namespace byre
