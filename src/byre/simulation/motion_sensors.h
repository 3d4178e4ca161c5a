#pragma once

#include "byre/body_motion.h"

#include <cstdint>

namespace byre {

// How the wheels and the gyroscope of a simulated robot err: two driven wheels with cheap encoders, and gyroscope and
// accelerometer of a consumer's part (as the ICM-20948's data sheet has it). All that is drawn follows from the seed.
struct MotionSensorOptions {
  double wheel_distance = 0.6;       // metres between the wheels
  double radius_error = 0.01;        // share by which both wheels are smaller than the odometry takes them to be
  double radius_difference = 0.002;  // share by which the left wheel is larger than the right one
  double slip = 0.01;                // deviation of each wheel's way, as a share of it
  double tick = 0.001;               // metres of a wheel's way that an encoder resolves
  double wheel_rate_hz = 50.0;
  double wheel_delay = 0.03;           // seconds that wheels stamp later
  double lifted_from = 0.0;            // seconds from the start, when the left wheel begins to spin freely
  double lifted_to = 0.0;              // seconds from the start
  double rate_noise = 2.6e-4;          // radians per second and square root of a hertz
  double rate_bias = 0.02;             // radians per second, deviation of the bias about each axis
  double acceleration_noise = 2.3e-3;  // m/s^2 and square root of a hertz
  double acceleration_bias = 0.05;     // m/s^2, deviation of the bias along each axis, once it was calibrated at rest
  std::uint64_t seed = 1;
};

// What they tell while the body, whose origin lies on the floor between the wheels, moves along its true path:
// gyroscope and accelerometer samples at each pose of the path, about the body's axes, at the body's origin.
MotionSamples simulated_motion(const Trajectory& world_from_body, const MotionSensorOptions& options);

}  // namespace byre
