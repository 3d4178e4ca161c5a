#pragma once

#include "byre/body_motion.h"
#include "byre/odometry/gyroscope_calibration.h"
#include "byre/odometry/rate_track.h"
#include "byre/odometry/stationary_detector.h"
#include "byre/odometry/wheel_calibration.h"
#include "byre/odometry/wheel_track.h"

#include <optional>

namespace byre {

// Samples of wheels and IMU, and the calibration by which they measure the body's motion. Borrows the samples.
struct CalibratedOdometry {
  const WheelTrack& wheels;
  const RateTrack& rates;
  const StationaryDetector& stationary;
  const WheelCalibration* calibration = nullptr;  // wheel calibration; nullptr if neither estimated nor assumed
  const std::optional<GyroscopeCalibration>& gyroscope;
  double time_offset = 0.0;        // delay of wheel stamps against the camera's, seconds
  double time_offset_sigma = 0.0;  // seconds
  bool is_slipping = false;
  bool is_unproven = false;  // few motions agree yet with the calibration of an earlier drive
};

// Motion of the base by wheels alone, metres.
std::optional<Pose> base_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later);

// Same, with turns of the gyroscope if available. Precondition: there is a calibration.
std::optional<Pose> base_path_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later);

// Whether wheels measured standstill over the last window before a time; empty: no measurement.
std::optional<bool> are_wheels_stationary(const CalibratedOdometry& odometry, Timestamp time);
std::optional<SteadyWindow::Steady> standstill_by_wheels(const CalibratedOdometry& odometry, Timestamp time);

// The body's motion in lengths of the map: translation from wheels, rotation from the gyroscope if available.
std::optional<BodyMotion> path_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later);

// Same, for present frames: ignores slipping wheels, bridges jumps of the wheel pose and constrains the body at
// standstill. predicted: motion by the last visual velocity, which takes the place of the translation without wheels.
std::optional<BodyMotion> motion_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later,
                                         const std::optional<BodyMotion>& predicted);

// See OdometryCalibrator::reach. arm: from the base to the body, metres.
std::optional<double> reach_between(const CalibratedOdometry& odometry, Timestamp earlier, Timestamp later, double arm);

}  // namespace byre
