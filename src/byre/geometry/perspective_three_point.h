#pragma once

#include "byre/pose.h"

#include <array>
#include <vector>

namespace byre {

// All poses camera_from_world that see three points along three unit bearings: at most four, exact to rounding. Empty
// if the points are collinear or no pose fits. Depths by the conics of Lambda Twist (Persson and Nordberg, ECCV 2018).
std::vector<Pose> perspective_three_point(const std::array<Eigen::Vector3d, 3>& points_in_world,
                                          const std::array<Eigen::Vector3d, 3>& bearings_in_camera);

}  // namespace byre
