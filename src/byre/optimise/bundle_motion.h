#pragma once

#include "byre/optimise/bundle_adjustment.h"

namespace byre {

// What a told motion says of two poses: how far they are from it, as a small motion of the later one, and what that
// counts for. The loss is Cauchy's: a motion that is far off, as of a wheel that spins, has next to no say.
struct MotionError {
  Vector6 residual;     // exp_pose(residual) * told = later_from_earlier of the poses, to first order
  double cost = 0.0;    // twice its share of the cost
  double weight = 0.0;  // influence that the loss leaves it, 1 at no error
};
MotionError motion_error(const BundleMotion& motion, const Pose& earlier_from_world, const Pose& later_from_world);

// Slopes of the residual by delta in exp_pose(delta) * camera_from_world, to first order.
struct MotionSlopes {
  Matrix6 by_earlier;
  Matrix6 by_later;
};
MotionSlopes motion_slopes(const Pose& earlier_from_world, const Pose& later_from_world);

// The same by a turn, then a translation, that are each added to the pose's own (see Reprojection).
Matrix6 by_turn_and_translation(const Matrix6& slope, const Pose& camera_from_world);

}  // namespace byre
