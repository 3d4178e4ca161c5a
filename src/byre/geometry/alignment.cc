#include "byre/alignment.h"

#include "byre/geometry/decompositions.h"

#include <cassert>

namespace byre {
namespace {

using Points = std::span<const Eigen::Vector3d>;

Eigen::Vector3d mean(Points points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

}  // namespace

Pose scale_lengths(const Pose& pose, double scale) {
  return {pose.rotation, scale * pose.translation};
}

Matrix6 scale_lengths(const Matrix6& covariance, double scale) {
  Vector6 factors;
  factors << Eigen::Vector3d::Constant(scale), Eigen::Vector3d::Ones();
  return factors.asDiagonal() * covariance * factors.asDiagonal();
}

Pose move_camera(const Similarity& target_from_source, const Pose& camera_from_source) {
  return scale_lengths(camera_from_source, target_from_source.scale) * inverse(target_from_source.target_from_source);
}

std::optional<Similarity> align(Points points_in_source, Points points_in_target, Scale scale) {
  assert(points_in_source.size() == points_in_target.size());
  if (points_in_source.size() < 3) return std::nullopt;
  const Eigen::Vector3d source_mean = mean(points_in_source);
  const Eigen::Vector3d target_mean = mean(points_in_target);
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // eq. 38, times the number of points
  double source_variance = 0.0;                          // eq. 36, times the number of points
  for (std::size_t i = 0; i < points_in_source.size(); ++i) {
    const Eigen::Vector3d source = points_in_source[i] - source_mean;
    covariance += (points_in_target[i] - target_mean) * source.transpose();
    source_variance += source.squaredNorm();
  }

  const auto [left, singular, right] = singular_values(covariance);
  // Points on one line leave one singular value and a free rotation about the line. Quadratic in the line's width.
  constexpr double kThinnest = 1e-9;
  if (!(singular[1] > kThinnest * singular[0])) return std::nullopt;

  Eigen::Vector3d sign = Eigen::Vector3d::Ones();  // eq. 39 and 43: a rotation, never a reflection
  if ((left * right.transpose()).determinant() < 0.0) sign.z() = -1.0;
  Similarity result;
  result.target_from_source.rotation =
      Eigen::Quaterniond(Eigen::Matrix3d(left * sign.asDiagonal() * right.transpose())).normalized();
  if (scale == Scale::free) result.scale = singular.dot(sign) / source_variance;  // eq. 42
  result.target_from_source.translation =
      target_mean - result.target_from_source.rotation * (result.scale * source_mean);  // eq. 41
  return result;
}

}  // namespace byre
