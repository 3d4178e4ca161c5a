#pragma once

#include "byre/motion/seen_motion.h"

#include <deque>
#include <optional>

namespace byre {

// How the gyroscope is turned against the body, and what it tells of a body at rest.
struct GyroscopeMounting {
  Eigen::Quaterniond body_from_gyroscope = Eigen::Quaterniond::Identity();
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();  // radians per second, about the gyroscope's axes
  double error = 0.0;                              // median difference from what was seen, radians per second
  // Covariance of a small turn of body_from_gyroscope, about the body's axes: wide about the only axis that was turned
  // about, and about all while nothing is known.
  Eigen::Matrix3d covariance = kOpenTurn * Eigen::Matrix3d::Identity();

  static constexpr double kOpenTurn = 3.3;  // square radians: any angle is as good
};

// By turns that were seen, of some seconds at least; the bias is that of the last half minute. Where all turns are
// about one axis, how the gyroscope is turned about that one stays open, and matters to no such turn. Empty while too
// little was turned, or what it tells is not what was seen.
// known: how it was found to be turned before; then two seconds tell the bias, also of a body that does not turn.
std::optional<GyroscopeMounting> find_gyroscope_mounting(const std::deque<SeenMotion>& seen,
                                                         const std::optional<GyroscopeMounting>& known = {});

}  // namespace byre
