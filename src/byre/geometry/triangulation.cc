#include "byre/geometry/triangulation.h"

#include <cmath>

namespace byre {
namespace {

// Lee and Civera 2019, eq. 11: reversing either ray does not bring the two points on the rays closer.
bool meet_in_front(const Eigen::Vector3d& baseline, const Eigen::Vector3d& on_first, const Eigen::Vector3d& on_second) {
  const double gap = (on_first - baseline - on_second).squaredNorm();
  return gap < (on_first - baseline + on_second).squaredNorm() &&
         gap < (-on_first - baseline - on_second).squaredNorm() &&
         gap < (-on_first - baseline + on_second).squaredNorm();
}

}  // namespace

std::optional<Eigen::Vector3d> triangulate(const Eigen::Vector3d& bearing_in_first,
                                           const Eigen::Vector3d& bearing_in_second, const Pose& second_from_first,
                                           double min_angle) {
  const Pose first_from_second = inverse(second_from_first);
  const Eigen::Vector3d& baseline = first_from_second.translation;
  const Eigen::Vector3d first = bearing_in_first.normalized();
  const Eigen::Vector3d second = first_from_second.rotation * bearing_in_second.normalized();

  const double sine = first.cross(second).norm();
  // Rays towards each other determine depth as badly as parallel ones, so the sine decides.
  if (!(sine > 0.0) || sine < std::sin(min_angle)) return std::nullopt;
  // Depths by the sine rule, in the triangle of both cameras and the point.
  const double first_depth = second.cross(baseline).norm() / sine;
  const double second_depth = first.cross(baseline).norm() / sine;
  if (!(first_depth > 0.0 && second_depth > 0.0)) return std::nullopt;
  if (!meet_in_front(baseline, first_depth * first, second_depth * second)) return std::nullopt;
  // Eq. 10: points on the rays weighted by inverse depth.
  return first_depth / (first_depth + second_depth) * (baseline + second_depth * (first + second));
}

}  // namespace byre
