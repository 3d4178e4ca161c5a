#pragma once

#include "byre/pose.h"

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

// Deviation of a wheel calibration: rotation about the axes of the base (radians, base_from_body.rotation is preceded
// by it), lever arm (metres), natural logarithm of metres_per_unit, TurnErrors::scale, TurnErrors::per_metre.
using WheelDeviation = Eigen::Matrix<double, 9, 1>;
using WheelCovariance = Eigen::Matrix<double, 9, 9>;

// Pose of the body on the base, scale of the map from wheels, and errors of turns, as a Gaussian: wide before the
// first motions, narrow if it was measured by hand or estimated.
struct WheelCalibration {
  Pose base_from_body;           // metres
  double metres_per_unit = 1.0;  // metres, measured by wheels, per unit of the map
  TurnErrors turn_errors;
  WheelCovariance covariance = WheelCovariance::Zero();
  double translation_error = 0.0;  // median difference of motions from wheels and images, as a share of the path length
  // Same for sideways motions, as a share of the sideways path length. Omnidirectional wheels slip more sideways.
  // The default holds until sideways motions are measured; other wheels never need it.
  double lateral_error = 0.2;
  double rotation_error = 0.0;  // median relative error of turns after correction of turn_errors

  Eigen::Vector3d up_in_body() const { return base_from_body.rotation.conjugate() * Eigen::Vector3d::UnitZ(); }
  double tilt_sigma() const;     // radians, of the base's up axis in the body
  double heading_sigma() const;  // radians, about the base's up axis
  double arm_sigma() const;      // metres, of the lever arm in the driving plane
  double scale_sigma() const;    // relative standard deviation of metres_per_unit
};

// Deviation of the second calibration from the first.
WheelDeviation difference(const WheelCalibration& from, const WheelCalibration& to);

// The calibration without knowledge of metres_per_unit.
WheelCalibration with_unknown_scale(WheelCalibration calibration);

// Covariance of the usual change from day to day: tyre wear and pressure, and brackets that give way a little.
WheelCovariance day_to_day_covariance();

// Priors of an estimate.
WheelCalibration unknown_wheel_calibration();
// The heading and the scale are unknown. tilt_sigma: radians.
WheelCalibration upright_wheel_calibration(const Eigen::Vector3d& up_in_body, double tilt_sigma);
// Before any tracked motion: the body looks ahead, lengths are metres. The axes in the body are approximate. Empty if
// the body looks up or down. Its large errors allow another viewing direction, so that only the length of the path is
// constrained.
std::optional<WheelCalibration> forward_facing_calibration(const Eigen::Vector3d& up_in_body,
                                                           const Eigen::Vector3d& ahead_in_body);

// Most probable calibration by a prior and by motions, with its covariance: Gauss-Newton on the rotation and the
// translation of each motion, from a linear solution where the prior is wide (Heng, Li and Pollefeys, "CamOdoCal",
// IROS 2013, sections III.A and III.B). Outliers, such as wheel slip, are weighted down. Empty if turns of wheels and
// images have no common axis, or if the motions do not determine where to begin.
std::optional<WheelCalibration> estimate_wheel_calibration(const std::vector<MotionPair>& motions,
                                                           const WheelCalibration& prior = unknown_wheel_calibration());

// Displacement of a base to its left, relative to its driving arc, metres. Zero for wheels that only roll ahead.
double lateral_displacement(const Pose& base);

// The body's motion, in lengths of the map, from the base's motion.
Pose body_motion(const WheelCalibration& calibration, const Pose& base);

}  // namespace byre
