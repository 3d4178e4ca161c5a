#pragma once

#include "byre/trajectory.h"

#include <chrono>
#include <optional>

namespace byre {

// Longest interval between tracked frames without a gap between them.
inline constexpr Timestamp kMaxFrameGap = std::chrono::milliseconds(300);

// Largest accelerations of a body.
inline constexpr double kMostAcceleration = 15.0;  // m/s^2
inline constexpr double kMostTurning = 30.0;       // radians per second squared

// The body's motion between two tracked frames from images, earlier_from_later, in lengths of the map.
struct VisualMotion {
  Timestamp earlier{};
  Timestamp later{};
  Pose body;
  double focal_change = 1.0;                        // focal length used, over that of the given calibration
  std::optional<Eigen::Vector3d> gyroscope_turn{};  // radians about the gyroscope's axes, with its bias
};

// Difference between the same motion from wheels and from images, as a multiple of the tolerance.
double disagreement(const Pose& measured, const VisualMotion& seen, double metres_per_unit);

}  // namespace byre
