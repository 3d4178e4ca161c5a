#include "byre/geometry/homography.h"

#include "byre/geometry/decompositions.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace byre {
namespace {

using Matrix9 = Eigen::Matrix<double, 9, 9>;
using Vector9 = Eigen::Matrix<double, 9, 1>;

// Normalises points at z = 1: zero mean and a mean distance of sqrt(2).
template <typename PointOf>
Eigen::Matrix3d normalisation(std::span<const TwoViewMatch> matches, PointOf point_of) {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const TwoViewMatch& match : matches) mean += point_of(match);
  mean /= static_cast<double>(matches.size());
  double distance = 0.0;
  for (const TwoViewMatch& match : matches) distance += (point_of(match) - mean).norm();
  const double scale = std::numbers::sqrt2 * static_cast<double>(matches.size()) / distance;
  Eigen::Matrix3d normalised_from_point;
  normalised_from_point << scale, 0.0, -scale * mean.x(),  //
      0.0, scale, -scale * mean.y(),                       //
      0.0, 0.0, 1.0;
  return normalised_from_point;
}

// The two equations of a match, linear in the entries of the homography, row by row.
Eigen::Matrix<double, 2, 9> equations_of(const Eigen::Vector3d& first, const Eigen::Vector3d& second) {
  Eigen::Matrix<double, 2, 9> equations = Eigen::Matrix<double, 2, 9>::Zero();
  equations.block<1, 3>(0, 3) = -first.transpose();
  equations.block<1, 3>(0, 6) = second.y() * first.transpose();
  equations.block<1, 3>(1, 0) = first.transpose();
  equations.block<1, 3>(1, 6) = -second.x() * first.transpose();
  return equations;
}

// The null vector as a matrix; empty if the null space has more than one dimension.
std::optional<Eigen::Matrix3d> null_matrix(const Matrix9& normal_matrix) {
  constexpr double kDegenerate = 1e-12;  // limit on the second-smallest over the largest eigenvalue
  const Eigen::SelfAdjointEigenSolver<Matrix9> eigen(normal_matrix);
  if (!(eigen.eigenvalues()[1] > kDegenerate * eigen.eigenvalues()[8])) return std::nullopt;
  const Vector9 entries = eigen.eigenvectors().col(0);
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(entries.data());
}

// The motion that causes the homography for the plane spanned by `middle` and `unchanged`, two orthogonal unit
// directions whose lengths the homography keeps.
Pose motion_of_plane(const Eigen::Matrix3d& homography, const Eigen::Vector3d& middle,
                     const Eigen::Vector3d& unchanged) {
  const Eigen::Vector3d normal = middle.cross(unchanged);
  const Eigen::Vector3d moved_middle = homography * middle;
  const Eigen::Vector3d moved_unchanged = homography * unchanged;
  Eigen::Matrix3d before, after;
  before << middle, unchanged, normal;
  after << moved_middle, moved_unchanged, moved_middle.cross(moved_unchanged);
  const Eigen::Matrix3d rotation = after * before.transpose();
  return {Eigen::Quaterniond(rotation).normalized(), ((homography - rotation) * normal).normalized()};
}

Pose reversed(const Pose& motion) {
  return {motion.rotation, -motion.translation};
}

}  // namespace

std::optional<Eigen::Matrix3d> fit_homography(std::span<const TwoViewMatch> matches) {
  if (matches.size() < 4) return std::nullopt;
  const Eigen::Matrix3d normalise_first =
      normalisation(matches, [](const TwoViewMatch& match) { return match.ray_in_first.head<2>(); });
  const Eigen::Matrix3d normalise_second =
      normalisation(matches, [](const TwoViewMatch& match) { return match.ray_in_second.head<2>(); });
  if (!normalise_first.allFinite() || !normalise_second.allFinite()) return std::nullopt;
  Matrix9 normal_matrix = Matrix9::Zero();
  for (const TwoViewMatch& match : matches) {
    const auto equations = equations_of(normalise_first * match.ray_in_first, normalise_second * match.ray_in_second);
    normal_matrix.noalias() += equations.transpose() * equations;
  }
  const auto normalised = null_matrix(normal_matrix);
  if (!normalised) return std::nullopt;
  const Eigen::Matrix3d homography = normalise_second.inverse() * *normalised * normalise_first;
  const double scale = singular_values(homography).values[1];
  // Points in front of one camera are in front of the other.
  const Eigen::Vector3d& first = matches.front().ray_in_first;
  const double sign = matches.front().ray_in_second.dot(homography * first) < 0.0 ? -1.0 : 1.0;
  if (!(std::abs(homography.determinant()) > 1e-9 * scale * scale * scale)) return std::nullopt;
  return sign / scale * homography;
}

std::vector<Pose> motions_from_homography(const Eigen::Matrix3d& homography) {
  constexpr double kRotation = 1e-9;  // difference of squared singular values below which the homography is a rotation
  const Eigen::Matrix3d squared = homography.transpose() * homography;
  const SymmetricEigen<3> eigen = symmetric_eigen(squared);
  const double least = eigen.values[0];
  const double largest = eigen.values[2];
  if (!(largest - least > kRotation)) return {};
  const double along_least = std::sqrt(std::max(0.0, 1.0 - least) / (largest - least));
  const double along_largest = std::sqrt(std::max(0.0, largest - 1.0) / (largest - least));
  // The homography keeps the length of the sum and of the difference of these two parts.
  const Eigen::Vector3d largest_part = along_least * eigen.vectors.col(2);
  const Eigen::Vector3d least_part = along_largest * eigen.vectors.col(0);
  const Eigen::Vector3d middle = eigen.vectors.col(1);
  const Pose one = motion_of_plane(homography, middle, (largest_part + least_part).normalized());
  const Pose other = motion_of_plane(homography, middle, (largest_part - least_part).normalized());
  return {one, reversed(one), other, reversed(other)};
}

}  // namespace byre
