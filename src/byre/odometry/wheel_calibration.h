#pragma once

#include "byre/pose.h"

#include <cstdint>
#include <optional>
#include <vector>

namespace byre {

// The same motion from wheels and from images, both earlier_from_later.
struct MotionPair {
  Pose base;  // metres
  Pose body;  // in lengths of the map
};

// Systematic errors of turns from wheels: a wrong track width, and unequal wheel diameters (Borenstein and Feng,
// "Measurement and Correction of Systematic Odometry Errors in Mobile Robots", 1996).
struct TurnErrors {
  double scale = 1.0;      // true turn per measured radian
  double per_metre = 0.0;  // radians to the left to add per measured metre ahead
};

// The base's motion with these errors corrected, earlier_from_later; for spans of a second at most.
Pose without_turn_errors(const TurnErrors& errors, const Pose& base);

// Pose of the body on the base, and scale of the map from wheels. The base drives in its plane, so the height of the
// body above it is unobservable and set to zero.
struct WheelCalibration {
  Pose base_from_body;             // metres
  double metres_per_unit = 1.0;    // metres, measured by wheels, per unit of the map
  double scale_sigma = 0.0;        // relative standard deviation of metres_per_unit
  double translation_error = 0.0;  // median difference of motions from wheels and images, as a share of the path length
  // Same for sideways motions, as a share of the sideways path length. Omnidirectional wheels slip more sideways.
  // The default holds until sideways motions are measured; other wheels never need it.
  double lateral_error = 0.2;
  double rotation_error = 0.0;  // median relative error of turns after correction of turn_errors
  TurnErrors turn_errors;
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Zero();  // covariance of constrained_parameters
};

// Parameters that motions constrain, with the up axis of the body given: metres_per_unit times cosine and sine of the
// angle from the levelled body to the base, and the lever arm in metres.
Eigen::Vector4d constrained_parameters(const WheelCalibration& calibration, const Eigen::Vector3d& up_in_body);

// Covariance of their usual change from day to day: tyre wear and pressure, and brackets that give way a little.
Eigen::Matrix4d day_to_day_covariance(const WheelCalibration& calibration);

// Estimates the calibration from motions in which the base turned both ways or far, and drove. First the common axis of
// turns and their systematic errors; then, by linear least squares, the forward direction, the lever arm and the scale
// (Heng, Li and Pollefeys, "CamOdoCal", IROS 2013, sections III.A and III.B). Outliers, such as wheel slip, are
// weighted down. Empty if the motions do not constrain it. known: earlier estimate, a prior; then few motions suffice.
std::optional<WheelCalibration> estimate_wheel_calibration(const std::vector<MotionPair>& motions,
                                                           const std::optional<WheelCalibration>& known = {});

// Source of the up axis: measured by an accelerometer, or assumed from an upright camera.
enum class UpSource : std::uint8_t { assumed, measured };

// Provisional calibration from about a metre of path. The assumed up axis is corrected by turns and by the driving
// direction, the lever arm has a short prior, and the forward direction is estimated. up_in_body: approximate. Empty if
// the motions do not constrain the forward direction.
std::optional<WheelCalibration> estimate_initial_wheel_calibration(const std::vector<MotionPair>& motions,
                                                                   const Eigen::Vector3d& up_in_body,
                                                                   UpSource source = UpSource::assumed);

// Displacement of a base to its left, relative to its driving arc, metres. Zero for wheels that only roll ahead.
double lateral_displacement(const Pose& base);

// Provisional calibration before any tracked motion: the body is upright, looks ahead and is above the middle of the
// base; lengths are metres. The axes in the body are approximate. Empty if the body looks up or down. Its large errors
// allow another viewing direction, so that only the length of the path is constrained.
std::optional<WheelCalibration> forward_facing_calibration(const Eigen::Vector3d& up_in_body,
                                                           const Eigen::Vector3d& ahead_in_body);

// The body's motion, in lengths of the map, from the base's motion.
Pose body_motion(const WheelCalibration& calibration, const Pose& base);

}  // namespace byre
