#pragma once

#include "byre/pose.h"

#include <optional>

namespace byre {

// Pose of a sensor on the robot's base. The base has x ahead, y to the left and z up, as in REP-103, and drives in its
// x-y plane; its origin is the point whose motion the wheel odometry measures, for two driven wheels the middle between
// them.
struct SensorMounting {
  Pose base_from_sensor;     // metres
  double sigma_m = 0.02;     // standard deviation of the translation, each axis; the default is that of a tape measure
  double sigma_rad = 0.035;  // standard deviation of the rotation, about each axis; the default is 2 degrees
};

// Extrinsics of a robot as measured by hand, designed, or found on an earlier drive. They are the start of an estimate:
// driving refines them, and a mounting that motions contradict is reported and dropped.
struct Extrinsics {
  // Left or only camera: x to the right of the image, y down, z ahead. Empty: estimated while driving.
  std::optional<SensorMounting> camera;
  // Gyroscope and accelerometer. Empty: estimated while driving.
  std::optional<SensorMounting> imu;
  double wheel_scale = 1.0;           // true metres per metre of the wheel odometry
  double wheel_scale_sigma = 0.03;    // relative standard deviation
  std::optional<double> wheel_delay;  // delay of the wheels' stamps against the images', seconds; empty: estimated
};

}  // namespace byre
