#pragma once

#include "byre/optimise/bundle_adjustment.h"

namespace byre {

// Error of two poses under a measured motion, as a small motion of the later pose. The Cauchy loss leaves gross errors,
// such as of a spinning wheel, almost no influence.
struct MotionError {
  Vector6 residual;     // exp_pose(residual) * measured = later_from_earlier of the poses, to first order
  double cost = 0.0;    // robust squared error; the cost counts half of it
  double weight = 0.0;  // factor on the information by the loss, 1 at zero error
};
MotionError motion_error(const BundleMotion& motion, const Pose& earlier_from_world, const Pose& later_from_world);

// Derivatives of the residual by delta in exp_pose(delta) * camera_from_world, to first order.
struct MotionJacobians {
  Matrix6 by_earlier;
  Matrix6 by_later;
};
MotionJacobians motion_jacobians(const Pose& earlier_from_world, const Pose& later_from_world);

// Converts a derivative by delta to one by rotation, then translation, added to the pose's own (see Reprojection).
Matrix6 to_rotation_translation(const Matrix6& jacobian, const Pose& camera_from_world);

}  // namespace byre
