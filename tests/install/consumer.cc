// Aligns a triangle to a moved copy of itself and says how far the triangle was moved.

#include "byre/geometry/alignment.h"
#include "byre/geometry/pose.h"

#include <cstdio>
#include <vector>

int main() {
  const byre::Pose target_from_source{byre::rotation_exp({0.0, 0.0, 0.5}), {1.0, 2.0, 3.0}};
  const std::vector<Eigen::Vector3d> points_in_source = {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}};
  std::vector<Eigen::Vector3d> points_in_target;
  for (const Eigen::Vector3d& point_in_source : points_in_source) {
    points_in_target.push_back(target_from_source * point_in_source);
  }
  const auto found = byre::align(points_in_source, points_in_target, byre::Scale::fixed);
  if (!found) return 1;
  const Eigen::Vector3d moved = found->target_from_source.translation;
  std::printf("moved by %.3f %.3f %.3f\n", moved.x(), moved.y(), moved.z());
  return 0;
}
