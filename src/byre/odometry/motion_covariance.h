#pragma once

#include "byre/body_motion.h"
#include "byre/odometry/gyroscope_calibration.h"
#include "byre/odometry/wheel_calibration.h"

namespace byre {

// Covariance of the body's motion from wheels, in lengths of the map. motion: of the body; base: of the base, metres.
Matrix6 wheel_covariance(const Pose& motion, const Pose& base, const WheelCalibration& calibration);

// Sets the standard deviation of the translation to its length: spinning wheels may measure any path.
void set_translation_unknown(BodyMotion& motion);
// Sets the standard deviation of the rotation to its angle.
void set_rotation_unknown(BodyMotion& motion);
// Sets the covariance of a rotation that a gyroscope measured.
void set_turn_covariance(BodyMotion& motion, const GyroscopeCalibration& gyroscope, double seconds);

// Zero-velocity update: the motion with the small covariance of a body at standstill, which bounds drift.
BodyMotion constrain_to_standstill(BodyMotion motion, double seconds);

}  // namespace byre
