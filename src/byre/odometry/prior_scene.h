// For tests: motion priors that have followed a drive.

#pragma once

#include "byre/odometry/drive_scene.h"
#include "byre/odometry/odometry_calibrator.h"

#include <random>

namespace byre {

inline const Eigen::Vector3d kBias(0.02, -0.01, 0.03);  // radians per second
inline const Eigen::Quaterniond kBodyFromGyroscope = rotation_exp({0.3, 1.2, -0.4});

inline Eigen::Vector3d rate_of_body(const Drive& drive, double seconds) {
  constexpr double kStep = 0.002;
  const Pose base = inverse(Drive::world_from_base(seconds)) * Drive::world_from_base(seconds + kStep);
  return drive.base_from_body.rotation.conjugate() * rotation_log(base.rotation) / kStep;
}

// Sensors other than the camera, and errors of the wheels.
struct DriveSensors {
  bool wheels = true;
  bool gyroscope = false;
  double slip_from = 1e9;       // seconds, start of wheel slip
  double slip_to = 1e9;         // seconds
  double slip_turn = 0.0;       // radians added to each wheel sample during slip
  double turn_scale = 1.0;      // factor of turns measured by wheels
  double turn_per_metre = 0.0;  // radians per metre added to turns measured by wheels
};

// A prior after a drive. dark: time of the last tracked frame; end: of the last sample. known: from an earlier drive.
inline OdometryCalibrator followed(const Drive& drive, const DriveSensors& sensors, double dark, double end,
                                   const OdometryCalibration& known = {}) {
  OdometryCalibrator prior;
  prior.begin_with(known);
  std::mt19937 random(5);
  Pose wheels;
  for (int step = 0; step * 0.01 < end; ++step) {
    const double t = step * 0.01;
    if (sensors.wheels && step % 2 == 0) {
      Pose motion = inverse(Drive::world_from_base(t - 0.02)) * Drive::world_from_base(t);
      const Eigen::Vector3d turn = rotation_log(motion.rotation);
      motion.rotation =
          rotation_exp(sensors.turn_scale * turn + Eigen::Vector3d(0.0, 0.0, 0.01 * sensors.turn_per_metre));
      if (t > sensors.slip_from && t < sensors.slip_to) {
        motion.translation.x() += 0.02;
        motion.rotation = motion.rotation * rotation_exp({0.0, 0.0, sensors.slip_turn});
      }
      wheels = wheels * motion;
      prior.add(StampedPose{from_seconds(t + drive.wheel_delay), wheels});
    }
    if (sensors.gyroscope) {
      prior.add(AngularRate{from_seconds(t), kBodyFromGyroscope.conjugate() * rate_of_body(drive, t) + kBias});
    }
    if (step % 5 == 0) prior.note(from_seconds(t), t < dark ? std::optional(drive.seen(t, random)) : std::nullopt);
  }
  return prior;
}

inline Pose true_motion(const Drive& drive, double from, double to) {
  Drive exact = drive;
  exact.noise = 0.0;
  std::mt19937 random;
  return inverse(exact.seen(from, random)) * exact.seen(to, random);
}

// The product of the motions between frames, without images.
inline BodyMotion over(const OdometryCalibrator& prior, double from, double to) {
  BodyMotion sum = *prior.between(from_seconds(from), from_seconds(from + 0.05));
  for (double t = from + 0.05; t < to - 0.01; t += 0.05) {
    sum = sum * *prior.between(from_seconds(t), from_seconds(t + 0.05));
  }
  return sum;
}

}  // namespace byre
