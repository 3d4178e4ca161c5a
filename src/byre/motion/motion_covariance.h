#pragma once

#include "byre/body_motion.h"
#include "byre/motion/gyroscope_mounting.h"
#include "byre/motion/wheel_mounting.h"

namespace byre {

// Covariance of the body's motion from wheels, in lengths of the map. motion: of the body; base: of the base, metres.
Matrix6 wheel_covariance(const Pose& motion, const Pose& base, const WheelMounting& mounting);

// Sets the standard deviation of the translation to its length: spinning wheels may measure any path.
void forget_way(BodyMotion& motion);
// Sets the standard deviation of the rotation to its angle.
void forget_turn(BodyMotion& motion);
// Sets the covariance of a rotation that a gyroscope measured.
void set_turn_covariance(BodyMotion& motion, const GyroscopeMounting& gyroscope, double seconds);

// Zero-velocity update: the motion with the small covariance of a body at standstill, which bounds drift.
BodyMotion at_rest(BodyMotion motion, double seconds);

}  // namespace byre
