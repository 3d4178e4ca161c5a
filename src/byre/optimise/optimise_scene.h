#pragma once

// Synthetic truth for the tests of this room.

#include "byre/rig.h"

#include <random>

namespace byre {

inline Rig stereo_rig() {
  Rig rig;
  rig.width = 752;
  rig.height = 480;
  rig.focal = 435.0;
  rig.cx = 367.0;
  rig.cy = 252.0;
  rig.baseline = 0.11;
  return rig;
}

// Random draws with a seed. Braces, not parentheses, fix the order of draws in an expression.
class Draw {
 public:
  explicit Draw(unsigned seed) : generator_(seed) {}

  double uniform(double low, double high) { return low + (high - low) * unit_(generator_); }
  double normal(double sigma) { return sigma * normal_(generator_); }
  Eigen::Vector3d normal3(double sigma) { return {normal(sigma), normal(sigma), normal(sigma)}; }
  Vector6 motion(double metres, double radians) {
    Vector6 delta;
    delta.head<3>() = normal3(metres);
    delta.tail<3>() = normal3(radians);
    return delta;
  }
  // A point at least 20 pixels inside the image, 1 to 8 m deep.
  Eigen::Vector3d point_in_view(const Rig& rig) {
    const Eigen::Vector2d pixel{uniform(20.0, rig.width - 20.0), uniform(20.0, rig.height - 20.0)};
    const double depth = uniform(1.0, 8.0);
    return depth * rig.ray(pixel);
  }

 private:
  std::mt19937 generator_;
  std::normal_distribution<double> normal_;
  std::uniform_real_distribution<double> unit_;
};

}  // namespace byre
