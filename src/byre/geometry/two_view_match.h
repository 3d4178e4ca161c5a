#pragma once

#include <Eigen/Core>

namespace byre {

// Rays of a corner in two cameras, as by Rig::ray.
struct TwoViewMatch {
  Eigen::Vector3d ray_in_first;   // z = 1
  Eigen::Vector3d ray_in_second;  // z = 1
  double sigma = 1e-3;            // standard error of either ray, per axis at z = 1: pixels over focal length
};

}  // namespace byre
