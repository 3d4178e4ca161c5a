#include "byre/calibration.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace byre {
namespace {

// Both lens models distort a plane: z = 1 (radial_tangential), or vectors as long as the angle off the axis
// (equidistant). A vector v becomes v (1 + k1 s + k2 s^2 + k3 s^3 + k4 s^4) with s = |v|^2, plus the tangential part.
struct Lens {
  std::array<double, 4> radial{};                                       // k1..k4
  std::array<double, 2> tangential{};                                   // p1, p2
  double max_radius_squared = std::numeric_limits<double>::infinity();  // largest |v|^2 of the lens model's domain
};

Lens lens_of(const Camera& camera) {
  const std::array<double, 5>& d = camera.distortion;
  switch (camera.model) {
    case CameraModel::pinhole:
      break;
    case CameraModel::radial_tangential:
      return {.radial = {d[0], d[1], d[4], 0.0}, .tangential = {d[2], d[3]}};
    case CameraModel::equidistant:
      return {.radial = {d[0], d[1], d[2], d[3]}, .max_radius_squared = std::numbers::pi * std::numbers::pi / 4.0};
  }
  return {};
}

// Whether a polynomial is positive on [0, 1], from its five Bernstein coefficients. It lies in their convex hull, so
// positive coefficients suffice. Otherwise de Casteljau's subdivision decides, to an interval of 2^-halvings.
bool is_positive(const std::array<double, 5>& bernstein, int halvings) {
  if (std::all_of(bernstein.begin(), bernstein.end(), [](double value) { return value > 0.0; })) return true;
  if (!(bernstein.front() > 0.0 && bernstein.back() > 0.0) || halvings == 0) return false;
  std::array<double, 5> left{}, right = bernstein;
  for (int kept = 0; kept < 5; ++kept) {
    left[kept] = right[0];
    for (int i = 0; i < 4 - kept; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
  }
  return is_positive(left, halvings - 1) && is_positive(right, halvings - 1);
}

// Whether the distorted radius increases monotonically with the true one from the axis to this radius.
bool is_in_field(const Lens& lens, double radius_squared) {
  if (!(radius_squared < lens.max_radius_squared)) return false;
  // Terms of the slope d(distorted radius) / d(radius), and its Bernstein form on [0, radius_squared].
  const double s = radius_squared;
  const double a1 = 3.0 * lens.radial[0] * s;
  const double a2 = 5.0 * lens.radial[1] * s * s;
  const double a3 = 7.0 * lens.radial[2] * s * s * s;
  const double a4 = 9.0 * lens.radial[3] * s * s * s * s;
  constexpr int kHalvings = 24;
  return is_positive(
      {1.0, 1.0 + a1 / 4.0, 1.0 + a1 / 2.0 + a2 / 6.0, 1.0 + 0.75 * a1 + a2 / 2.0 + a3 / 4.0, 1.0 + a1 + a2 + a3 + a4},
      kHalvings);
}

Eigen::Vector2d distort(const Lens& lens, const Eigen::Vector2d& v) {
  const auto& [k1, k2, k3, k4] = lens.radial;
  const auto& [p1, p2] = lens.tangential;
  const double s = v.squaredNorm();
  const double factor = 1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4)));
  const double twice_xy = 2.0 * v.x() * v.y();
  return {factor * v.x() + p1 * twice_xy + p2 * (s + 2.0 * v.x() * v.x()),
          factor * v.y() + p2 * twice_xy + p1 * (s + 2.0 * v.y() * v.y())};
}

Eigen::Matrix2d distortion_jacobian(const Lens& lens, const Eigen::Vector2d& v) {
  const auto& [k1, k2, k3, k4] = lens.radial;
  const auto& [p1, p2] = lens.tangential;
  const double s = v.squaredNorm();
  const double factor = 1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4)));
  const double factor_slope = k1 + s * (2.0 * k2 + s * (3.0 * k3 + s * 4.0 * k4));  // d factor / d s
  const double mixed = 2.0 * (factor_slope * v.x() * v.y() + p1 * v.x() + p2 * v.y());
  Eigen::Matrix2d jacobian;
  jacobian << factor + 2.0 * factor_slope * v.x() * v.x() + 2.0 * p1 * v.y() + 6.0 * p2 * v.x(), mixed,  //
      mixed, factor + 2.0 * factor_slope * v.y() * v.y() + 6.0 * p1 * v.y() + 2.0 * p2 * v.x();
  return jacobian;
}

// A Newton step, halved until it stays in the field and reduces the error.
std::optional<Eigen::Vector2d> newton_step(const Lens& lens, const Eigen::Vector2d& v,
                                           const Eigen::Vector2d& distorted) {
  const Eigen::Vector2d residual = distorted - distort(lens, v);
  Eigen::Vector2d step = distortion_jacobian(lens, v).inverse() * residual;
  constexpr int kHalvings = 40;
  for (int i = 0; i < kHalvings; ++i, step *= 0.5) {
    const Eigen::Vector2d trial = v + step;
    const bool nearer = (distorted - distort(lens, trial)).squaredNorm() < residual.squaredNorm();
    if (nearer && is_in_field(lens, trial.squaredNorm())) return trial;
  }
  return std::nullopt;
}

std::optional<Eigen::Vector2d> undistort(const Lens& lens, const Eigen::Vector2d& distorted) {
  constexpr int kMaxSteps = 60;
  const double tolerance = 1e-14 * (1.0 + distorted.norm());
  Eigen::Vector2d v = Eigen::Vector2d::Zero();
  for (int i = 0; i < kMaxSteps; ++i) {
    if ((distorted - distort(lens, v)).norm() <= tolerance) return v;
    const std::optional<Eigen::Vector2d> next = newton_step(lens, v, distorted);
    if (!next) return std::nullopt;
    v = *next;
  }
  return std::nullopt;
}

// Precondition: point.z() > 0.
Eigen::Vector2d to_plane(CameraModel model, const Eigen::Vector3d& point) {
  if (model != CameraModel::equidistant) return point.head<2>() / point.z();
  const double off_axis = point.head<2>().norm();
  if (off_axis < 1e-12 * point.z()) return point.head<2>() / point.z();
  return point.head<2>() * (std::atan2(off_axis, point.z()) / off_axis);
}

Eigen::Vector3d to_direction(CameraModel model, const Eigen::Vector2d& v) {
  if (model != CameraModel::equidistant) return v.homogeneous().normalized();
  const double angle = v.norm();
  const double sinc = angle < 1e-8 ? 1.0 : std::sin(angle) / angle;
  return {sinc * v.x(), sinc * v.y(), std::cos(angle)};
}

}  // namespace

std::string_view to_string(CameraModel model) {
  switch (model) {
    case CameraModel::pinhole:
      return "pinhole";
    case CameraModel::radial_tangential:
      return "radial_tangential";
    case CameraModel::equidistant:
      return "equidistant";
  }
  return "unknown";
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& point_in_camera) const {
  if (!(point_in_camera.z() > 0.0)) return std::nullopt;
  const Lens lens = lens_of(*this);
  const Eigen::Vector2d ideal = to_plane(model, point_in_camera);
  if (!is_in_field(lens, ideal.squaredNorm())) return std::nullopt;
  const Eigen::Vector2d distorted = distort(lens, ideal);
  return Eigen::Vector2d(fx * distorted.x() + cx, fy * distorted.y() + cy);
}

std::optional<Eigen::Vector3d> Camera::bearing(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  const std::optional<Eigen::Vector2d> ideal = undistort(lens_of(*this), distorted);
  if (!ideal) return std::nullopt;
  return to_direction(model, *ideal);
}

bool Camera::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
}

}  // namespace byre
