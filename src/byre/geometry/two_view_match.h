#pragma once

#include <Eigen/Core>

namespace byre {

// A corner as two cameras see it; rays as of Rig::ray.
struct TwoViewMatch {
  Eigen::Vector3d ray_in_first;   // z = 1
  Eigen::Vector3d ray_in_second;  // z = 1
  double sigma = 1e-3;            // standard error of either ray per axis at z = 1: pixels over focal length
};

}  // namespace byre
