#include "byre/geometry/perspective_three_point.h"

#include "byre/geometry/decompositions.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <Eigen/LU>

namespace byre {
namespace {

using Triple = std::array<Eigen::Vector3d, 3>;
using Conic = Eigen::Matrix3d;  // symmetric; the set of directions d with d^T C d = 0

constexpr std::array<std::pair<int, int>, 3> kSides = {{{0, 1}, {0, 2}, {1, 2}}};

// Constraints on the depths, one per side: depth_i^2 + depth_j^2 - 2 cosine depth_i depth_j = squared_length.
struct Triangle {
  Eigen::Vector3d squared_lengths;
  Eigen::Vector3d cosines;
};

Triangle triangle_of(const Triple& points, const Triple& bearings) {
  Triangle triangle;
  for (int side = 0; side < 3; ++side) {
    const auto [i, j] = kSides[side];
    triangle.squared_lengths[side] = (points[i] - points[j]).squaredNorm();
    triangle.cosines[side] = bearings[i].dot(bearings[j]);
  }
  return triangle;
}

// The squared length of a side as a quadratic form of the depths.
Conic squared_length_form(const Triangle& triangle, int side) {
  const auto [i, j] = kSides[side];
  Conic form = Conic::Zero();
  form(i, i) = form(j, j) = 1.0;
  form(i, j) = form(j, i) = -triangle.cosines[side];
  return form;
}

// Conic through all solutions, from the ratio of two sides' lengths, which depends only on the direction of the depths.
Conic ratio_conic(const Triangle& triangle, int side, int other) {
  const Conic conic = triangle.squared_lengths[other] * squared_length_form(triangle, side) -
                      triangle.squared_lengths[side] * squared_length_form(triangle, other);
  return conic / conic.norm();
}

// The real root of x^3 + b x^2 + c x + d farthest from the inflection, which is the best conditioned one.
double real_root(double b, double c, double d) {
  const double p = c - b * b / 3.0;
  const double half_q = b * b * b / 27.0 - b * c / 6.0 + 0.5 * d;
  const double discriminant = half_q * half_q + p * p * p / 27.0;
  double t = 0.0;
  if (discriminant > 0.0) {
    const double u = -std::cbrt(half_q + std::copysign(std::sqrt(discriminant), half_q));
    t = u - p / (3.0 * u);
  } else if (p < 0.0) {
    const double radius = std::sqrt(-p / 3.0);
    const double cosine = std::min(1.0, std::abs(half_q) / (radius * radius * radius));
    t = -std::copysign(2.0 * radius * std::cos(std::acos(cosine) / 3.0), half_q);
  }
  double x = t - b / 3.0;
  for (int polish = 0; polish < 2; ++polish) {
    const double slope = (3.0 * x + 2.0 * b) * x + c;
    if (slope != 0.0) x -= (((x + b) * x + c) * x + d) / slope;
  }
  return x;
}

Eigen::Matrix3d cofactors(const Eigen::Matrix3d& matrix) {
  Eigen::Matrix3d result;
  result << matrix.col(1).cross(matrix.col(2)), matrix.col(2).cross(matrix.col(0)), matrix.col(0).cross(matrix.col(1));
  return result;
}

// Two conics with the same common directions as the original two; the first is a pair of lines.
struct LinePairAndConic {
  Conic line_pair;
  Conic conic;
};

LinePairAndConic degenerate_member(Conic first, Conic second) {
  if (std::abs(first.determinant()) > std::abs(second.determinant())) std::swap(first, second);
  const double leading = second.determinant();
  if (leading == 0.0) return {first, second};
  // det(first + x second) = 0.
  const double root = real_root(cofactors(second).cwiseProduct(first).sum() / leading,
                                cofactors(first).cwiseProduct(second).sum() / leading, first.determinant() / leading);
  return {first + root * second, std::abs(root) < 1.0 ? second : first};
}

// The two directions alpha * u + beta * v that lie on the conic; empty when they are complex.
std::optional<std::array<Eigen::Vector3d, 2>> intersect(const Conic& conic, const Eigen::Vector3d& u,
                                                        const Eigen::Vector3d& v) {
  const double a = u.dot(conic * u);
  const double half_b = u.dot(conic * v);
  const double c = v.dot(conic * v);
  const double discriminant = half_b * half_b - a * c;
  constexpr double kRounding = 1e-12;  // a double root may become slightly complex
  if (discriminant < -kRounding * (half_b * half_b + std::abs(a * c))) return std::nullopt;
  const double root = -(half_b + std::copysign(std::sqrt(std::max(0.0, discriminant)), half_b));
  return {{root * u + a * v, c * u + root * v}};
}

// The directions common to both conics, with arbitrary sign and length.
std::vector<Eigen::Vector3d> common_directions(const Conic& first, const Conic& second) {
  const auto [line_pair, conic] = degenerate_member(first, second);
  const SymmetricEigen<3> eigen = symmetric_eigen(line_pair);
  const double a = std::sqrt(std::max(0.0, eigen.values[2]));
  const double b = std::sqrt(std::max(0.0, -eigen.values[0]));
  const Eigen::Vector3d crossing = eigen.vectors.col(1);
  // The lines, as planes of directions, have the normals a e2 + b e0 and a e2 - b e0; both contain e1, their crossing.
  const Eigen::Vector3d along_e2 = b * eigen.vectors.col(2);
  const Eigen::Vector3d along_e0 = a * eigen.vectors.col(0);
  std::vector<Eigen::Vector3d> directions;
  for (const Eigen::Vector3d& on_line : {(along_e2 - along_e0).eval(), (along_e2 + along_e0).eval()}) {
    const auto pair = intersect(conic, crossing, on_line.normalized());
    if (pair) directions.insert(directions.end(), pair->begin(), pair->end());
  }
  return directions;
}

// Newton's method on the three squared lengths; empty unless it converges with all points in front of the camera.
std::optional<Eigen::Vector3d> polish(const Triangle& triangle, Eigen::Vector3d depths) {
  constexpr int kSteps = 3;
  Eigen::Vector3d residual;
  for (int step = 0; step <= kSteps; ++step) {
    Eigen::Matrix3d jacobian = Eigen::Matrix3d::Zero();
    for (int side = 0; side < 3; ++side) {
      const auto [i, j] = kSides[side];
      const double cosine = triangle.cosines[side];
      residual[side] = depths[i] * depths[i] + depths[j] * depths[j] - 2.0 * cosine * depths[i] * depths[j] -
                       triangle.squared_lengths[side];
      jacobian(side, i) = 2.0 * (depths[i] - cosine * depths[j]);
      jacobian(side, j) = 2.0 * (depths[j] - cosine * depths[i]);
    }
    const Eigen::Vector3d correction = jacobian.inverse() * residual;
    if (step == kSteps || !correction.allFinite()) break;
    depths -= correction;
  }
  constexpr double kTolerance = 1e-6;  // share of the largest squared length; a double solution converges slowly
  const bool met = residual.cwiseAbs().maxCoeff() < kTolerance * triangle.squared_lengths.maxCoeff();
  if (!met || !(depths.minCoeff() > 0.0)) return std::nullopt;
  return depths;
}

std::optional<Eigen::Vector3d> depths_along(const Triangle& triangle, Eigen::Vector3d direction) {
  if (direction.sum() < 0.0) direction = -direction;
  if (!(direction.minCoeff() > 0.0)) return std::nullopt;
  double sum_of_squared_lengths = 0.0;
  for (int side = 0; side < 3; ++side) {
    sum_of_squared_lengths += direction.dot(squared_length_form(triangle, side) * direction);
  }
  return polish(triangle, direction * std::sqrt(triangle.squared_lengths.sum() / sum_of_squared_lengths));
}

// Axes of the triangle: along its first side, in its plane, and normal to it.
Eigen::Matrix3d axes(const Triple& points) {
  const Eigen::Vector3d along = (points[1] - points[0]).normalized();
  const Eigen::Vector3d normal = along.cross(points[2] - points[0]).normalized();
  Eigen::Matrix3d result;
  result << along, normal.cross(along), normal;
  return result;
}

// Precondition: the two triangles are congruent.
Pose pose_between(const Triple& points_in_camera, const Triple& points_in_world) {
  const Eigen::Quaterniond rotation(Eigen::Matrix3d(axes(points_in_camera) * axes(points_in_world).transpose()));
  const Eigen::Vector3d centre_in_camera = (points_in_camera[0] + points_in_camera[1] + points_in_camera[2]) / 3.0;
  const Eigen::Vector3d centre_in_world = (points_in_world[0] + points_in_world[1] + points_in_world[2]) / 3.0;
  return {rotation.normalized(), centre_in_camera - rotation.normalized() * centre_in_world};
}

bool on_one_line(const Triple& points, const Triangle& triangle) {
  constexpr double kThinnest = 1e-6;  // height over longest side
  const double twice_area = (points[1] - points[0]).cross(points[2] - points[0]).norm();
  return !(twice_area > kThinnest * triangle.squared_lengths.maxCoeff());
}

}  // namespace

std::vector<Pose> perspective_three_point(const Triple& points_in_world, const Triple& bearings_in_camera) {
  const Triangle triangle = triangle_of(points_in_world, bearings_in_camera);
  std::vector<Pose> poses;
  if (on_one_line(points_in_world, triangle)) return poses;
  for (const Eigen::Vector3d& direction : common_directions(ratio_conic(triangle, 0, 2), ratio_conic(triangle, 1, 2))) {
    const std::optional<Eigen::Vector3d> depths = depths_along(triangle, direction);
    if (!depths) continue;
    const Triple points_in_camera = {(*depths)[0] * bearings_in_camera[0], (*depths)[1] * bearings_in_camera[1],
                                     (*depths)[2] * bearings_in_camera[2]};
    poses.push_back(pose_between(points_in_camera, points_in_world));
  }
  return poses;
}

}  // namespace byre
