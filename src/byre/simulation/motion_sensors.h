#pragma once

#include "byre/body_motion.h"

#include <cstdint>

namespace byre {

// Errors of a simulated robot's wheels, gyroscope and accelerometer: two driven wheels with cheap encoders, a
// consumer-grade IMU (values of the ICM-20948 data sheet). All draws depend on the seed.
struct MotionSensorOptions {
  double wheel_distance = 0.6;       // metres between the wheels
  double radius_error = 0.01;        // relative error by which the odometry overestimates both wheel radii
  double radius_difference = 0.002;  // relative amount by which the left wheel is larger than the right
  double slip = 0.01;                // standard deviation of each wheel's distance, relative
  double tick = 0.001;               // encoder resolution, metres
  double wheel_rate_hz = 50.0;
  double wheel_delay = 0.03;           // delay of wheel timestamps, seconds
  double lifted_from = 0.0;            // seconds from the start: the left wheel begins to spin freely
  double lifted_to = 0.0;              // seconds from the start: the left wheel grips again
  double rate_noise = 2.6e-4;          // radians per second and square root of a hertz
  double rate_bias = 0.02;             // radians per second, standard deviation per axis
  double acceleration_noise = 2.3e-3;  // m/s^2 and square root of a hertz
  double acceleration_bias = 0.05;     // m/s^2, standard deviation per axis after calibration at rest
  std::uint64_t seed = 1;
};

// Simulates sensors along a true trajectory. The body's origin is on the floor between the wheels; gyroscope and
// accelerometer are sampled at each pose, in the body's axes, at its origin.
MotionSamples simulate_motion(const Trajectory& world_from_body, const MotionSensorOptions& options);

}  // namespace byre
