#include "byre/base/enum_names.h"
#include "byre/calibration.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

namespace byre {
namespace {

// A lens maps directions to a plane by its projection, and distorts the plane: a vector v becomes
// v (1 + k1 s + k2 s^2 + k3 s^3 + k4 s^4) / (1 + k4' s + k5' s^2 + k6' s^3) with s = |v|^2, plus the tangential and the
// prism part. A tilted sensor adds a homography.
enum class Projection : std::uint8_t { perspective, equidistant, unified, extended_unified, double_sphere, arctangent };

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Lens {
  Projection projection = Projection::perspective;
  std::array<double, 4> radial{};         // k1..k4 of the numerator
  std::array<double, 2> tangential{};     // p1, p2
  double max_radius_squared = kInfinity;  // largest |v|^2 of the lens model's domain
  std::array<double, 3> denominator{};    // k4..k6 of the rational model
  std::array<double, 4> prism{};          // s1..s4
  std::array<double, 2> tilt{};           // radians about x and y
  std::array<double, 2> shape{};          // parameters of the projection in the order of CameraModel
};

// Smallest z / |point| of the double sphere's domain in front of the camera (Usenko et al. 2018, equations 43 to 45).
double least_forward(double xi, double alpha) {
  const double w1 = alpha <= 0.5 ? alpha / (1.0 - alpha) : (1.0 - alpha) / alpha;
  const double w2 = (w1 + xi) / std::sqrt(2.0 * w1 * xi + xi * xi + 1.0);
  return std::max(0.0, -w2);
}

// Squared radius on the plane of the directions at the edge of the double sphere's domain.
double max_double_sphere_radius_squared(double xi, double alpha) {
  const double z = least_forward(xi, alpha);
  const double second = xi + z;
  const double r_squared = 1.0 - z * z;
  const double depth = alpha * std::sqrt(r_squared + second * second) + (1.0 - alpha) * second;
  constexpr double kLeastDepth = 1e-9;
  return depth > kLeastDepth ? r_squared / (depth * depth) : kInfinity;
}

Lens lens_of(const Camera& camera) {
  constexpr double kHalfTurn = std::numbers::pi * std::numbers::pi / 4.0;
  const std::array<double, 14>& d = camera.distortion;
  const std::array<double, 4> two_radial = {d[0], d[1], 0.0, 0.0};
  const std::array<double, 2> tangential = {d[2], d[3]};
  switch (camera.model) {
    case CameraModel::pinhole:
      break;
    case CameraModel::radial_tangential:
      return {.radial = {d[0], d[1], d[4], 0.0}, .tangential = tangential};
    case CameraModel::equidistant:
      return {
          .projection = Projection::equidistant, .radial = {d[0], d[1], d[2], d[3]}, .max_radius_squared = kHalfTurn};
    case CameraModel::rational:
      return {.radial = {d[0], d[1], d[4], 0.0},
              .tangential = tangential,
              .denominator = {d[5], d[6], d[7]},
              .prism = {d[8], d[9], d[10], d[11]},
              .tilt = {d[12], d[13]}};
    case CameraModel::unified:
      return {.projection = Projection::unified,
              .radial = two_radial,
              .tangential = tangential,
              .max_radius_squared = d[4] > 0.0 ? 1.0 / (d[4] * d[4]) : kInfinity,
              .shape = {d[4], 0.0}};
    case CameraModel::extended_unified:
      return {.projection = Projection::extended_unified,
              .radial = two_radial,
              .tangential = tangential,
              .max_radius_squared = d[4] > 0.0 ? 1.0 / (d[4] * d[4] * d[5]) : kInfinity,
              .shape = {d[4], d[5]}};
    case CameraModel::double_sphere:
      return {.projection = Projection::double_sphere,
              .radial = two_radial,
              .tangential = tangential,
              .max_radius_squared = max_double_sphere_radius_squared(d[4], d[5]),
              .shape = {d[4], d[5]}};
    case CameraModel::field_of_view:
      return {.projection = Projection::arctangent,
              .radial = two_radial,
              .tangential = tangential,
              .max_radius_squared = kHalfTurn / (d[4] * d[4]),
              .shape = {d[4], 0.0}};
    case CameraModel::thin_prism_fisheye:
      return {.projection = Projection::equidistant,
              .radial = {d[0], d[1], d[4], d[5]},
              .tangential = tangential,
              .max_radius_squared = kHalfTurn,
              .prism = {d[6], 0.0, d[7], 0.0}};
  }
  return {};
}

// Whether a polynomial is positive on [0, 1], from its Bernstein coefficients. It lies in their convex hull, so
// positive coefficients suffice. Otherwise de Casteljau's subdivision decides, to an interval of 2^-halvings.
template <std::size_t kCount>
bool is_positive(const std::array<double, kCount>& bernstein, int halvings) {
  if (std::all_of(bernstein.begin(), bernstein.end(), [](double value) { return value > 0.0; })) return true;
  if (!(bernstein.front() > 0.0 && bernstein.back() > 0.0) || halvings == 0) return false;
  std::array<double, kCount> left{}, right = bernstein;
  for (std::size_t kept = 0; kept < kCount; ++kept) {
    left[kept] = right[0];
    for (std::size_t i = 0; i + 1 < kCount - kept; ++i) right[i] = 0.5 * (right[i] + right[i + 1]);
  }
  return is_positive(left, halvings - 1) && is_positive(right, halvings - 1);
}

constexpr int kSubdivisions = 24;

// Whether a polynomial is positive on [0, 1], from its coefficients by ascending power.
template <std::size_t kCount>
bool is_positive_polynomial(std::array<double, kCount> bernstein) {
  // b_i = sum over j <= i of C(i, j) / C(n, j) a_j: repeated sums of the scaled coefficients.
  double choices = 1.0;  // C(n, j)
  for (std::size_t j = 0; j < kCount; ++j) {
    bernstein[j] /= choices;
    choices *= static_cast<double>(kCount - 1 - j) / static_cast<double>(j + 1);
  }
  for (std::size_t pass = 1; pass < kCount; ++pass) {
    for (std::size_t i = kCount - 1; i >= pass; --i) bernstein[i] += bernstein[i - 1];
  }
  return is_positive(bernstein, kSubdivisions);
}

// Whether denominator and slope of the rational radius are positive up to this radius. With numerator N and denominator
// D, the slope has the sign of N D + 2 s (N' D - N D').
bool is_in_rational_field(const Lens& lens, double s) {
  const std::array<double, 4> n = {1.0, lens.radial[0] * s, lens.radial[1] * s * s, lens.radial[2] * s * s * s};
  const std::array<double, 4> d = {1.0, lens.denominator[0] * s, lens.denominator[1] * s * s,
                                   lens.denominator[2] * s * s * s};
  std::array<double, 7> slope{};
  for (std::size_t i = 0; i < n.size(); ++i) {
    for (std::size_t j = 0; j < d.size(); ++j) {
      slope[i + j] += n[i] * d[j] * (1.0 + 2.0 * static_cast<double>(i) - 2.0 * static_cast<double>(j));
    }
  }
  return is_positive_polynomial(d) && is_positive_polynomial(slope);
}

bool is_rational(const Lens& lens) {
  return lens.denominator != std::array<double, 3>{};
}

// Whether the distorted radius increases monotonically with the true one from the axis to this radius.
bool is_in_field(const Lens& lens, double radius_squared) {
  if (!(radius_squared < lens.max_radius_squared)) return false;
  if (is_rational(lens)) return is_in_rational_field(lens, radius_squared);
  // Terms of the slope d(distorted radius) / d(radius), and its Bernstein form on [0, radius_squared].
  const double s = radius_squared;
  const double a1 = 3.0 * lens.radial[0] * s;
  const double a2 = 5.0 * lens.radial[1] * s * s;
  const double a3 = 7.0 * lens.radial[2] * s * s * s;
  const double a4 = 9.0 * lens.radial[3] * s * s * s * s;
  return is_positive<5>(
      {1.0, 1.0 + a1 / 4.0, 1.0 + a1 / 2.0 + a2 / 6.0, 1.0 + 0.75 * a1 + a2 / 2.0 + a3 / 4.0, 1.0 + a1 + a2 + a3 + a4},
      kSubdivisions);
}

// The radial factor and its derivative by s.
std::array<double, 2> radial_factor(const Lens& lens, double s) {
  const auto& [k1, k2, k3, k4] = lens.radial;
  const double numerator = 1.0 + s * (k1 + s * (k2 + s * (k3 + s * k4)));
  const double slope = k1 + s * (2.0 * k2 + s * (3.0 * k3 + s * 4.0 * k4));
  if (!is_rational(lens)) return {numerator, slope};
  const auto& [d1, d2, d3] = lens.denominator;
  const double denominator = 1.0 + s * (d1 + s * (d2 + s * d3));
  const double denominator_slope = d1 + s * (2.0 * d2 + s * 3.0 * d3);
  return {numerator / denominator, (slope - numerator / denominator * denominator_slope) / denominator};
}

Eigen::Vector2d distort(const Lens& lens, const Eigen::Vector2d& v) {
  const auto& [p1, p2] = lens.tangential;
  const auto& [s1, s2, s3, s4] = lens.prism;
  const double s = v.squaredNorm();
  const double factor = radial_factor(lens, s).front();
  const double twice_xy = 2.0 * v.x() * v.y();
  return {factor * v.x() + p1 * twice_xy + p2 * (s + 2.0 * v.x() * v.x()) + s * (s1 + s * s2),
          factor * v.y() + p2 * twice_xy + p1 * (s + 2.0 * v.y() * v.y()) + s * (s3 + s * s4)};
}

Eigen::Matrix2d distortion_jacobian(const Lens& lens, const Eigen::Vector2d& v) {
  const auto& [p1, p2] = lens.tangential;
  const auto& [s1, s2, s3, s4] = lens.prism;
  const double s = v.squaredNorm();
  const auto [factor, factor_slope] = radial_factor(lens, s);
  const double mixed = 2.0 * (factor_slope * v.x() * v.y() + p1 * v.x() + p2 * v.y());
  Eigen::Matrix2d jacobian;
  jacobian << factor + 2.0 * factor_slope * v.x() * v.x() + 2.0 * p1 * v.y() + 6.0 * p2 * v.x(), mixed,  //
      mixed, factor + 2.0 * factor_slope * v.y() * v.y() + 6.0 * p1 * v.y() + 2.0 * p2 * v.x();
  const Eigen::Vector2d prism_slope(s1 + 2.0 * s2 * s, s3 + 2.0 * s4 * s);  // by s
  jacobian += prism_slope * (2.0 * v).transpose();
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

// Homography of a sensor tilted against the lens, as OpenCV defines it.
Eigen::Matrix3d tilt_homography(const std::array<double, 2>& tilt) {
  const Eigen::Matrix3d rotation =
      (Eigen::AngleAxisd(-tilt[1], Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(-tilt[0], Eigen::Vector3d::UnitX()))
          .toRotationMatrix();
  Eigen::Matrix3d onto_sensor;
  onto_sensor << rotation(2, 2), 0.0, -rotation(0, 2),  //
      0.0, rotation(2, 2), -rotation(1, 2),             //
      0.0, 0.0, 1.0;
  return onto_sensor * rotation;
}

bool is_tilted(const Lens& lens) {
  return lens.tilt != std::array<double, 2>{};
}

// Infinite outside the domain of the projection. Precondition: point.z() > 0.
Eigen::Vector2d to_plane(const Lens& lens, const Eigen::Vector3d& point) {
  const auto& [first, second] = lens.shape;
  const Eigen::Vector2d across = point.head<2>();
  const double z = point.z();
  const auto over = [&across](double depth) -> Eigen::Vector2d {
    if (!(depth > 0.0)) return Eigen::Vector2d::Constant(kInfinity);
    return across / depth;
  };
  switch (lens.projection) {
    case Projection::perspective:
      break;
    case Projection::equidistant: {
      const double off_axis = across.norm();
      if (off_axis < 1e-12 * z) return across / z;
      return across * (std::atan2(off_axis, z) / off_axis);
    }
    case Projection::unified:
      return over(z + first * point.norm());
    case Projection::extended_unified:
      return over(first * std::sqrt(second * across.squaredNorm() + z * z) + (1.0 - first) * z);
    case Projection::double_sphere: {
      if (!(z > least_forward(first, second) * point.norm())) return over(0.0);
      const double z2 = first * point.norm() + z;
      return over(second * std::hypot(across.norm(), z2) + (1.0 - second) * z2);
    }
    case Projection::arctangent: {
      const double twice_tangent = 2.0 * std::tan(0.5 * first);
      const double radius = across.norm() / z;
      if (radius < 1e-12) return across / z * (twice_tangent / first);
      return across / z * (std::atan(radius * twice_tangent) / (first * radius));
    }
  }
  return across / z;
}

// Not finite outside the domain of the projection.
Eigen::Vector3d to_direction(const Lens& lens, const Eigen::Vector2d& v) {
  const auto& [first, second] = lens.shape;
  const double r_squared = v.squaredNorm();
  switch (lens.projection) {
    case Projection::perspective:
      break;
    case Projection::equidistant: {
      const double angle = v.norm();
      const double sinc = angle < 1e-8 ? 1.0 : std::sin(angle) / angle;
      return {sinc * v.x(), sinc * v.y(), std::cos(angle)};
    }
    case Projection::unified: {
      const double scale = (first + std::sqrt(1.0 + (1.0 - first * first) * r_squared)) / (1.0 + r_squared);
      return Eigen::Vector3d(scale * v.x(), scale * v.y(), scale - first).normalized();
    }
    case Projection::extended_unified: {
      const double root = std::sqrt(1.0 - (2.0 * first - 1.0) * second * r_squared);
      const double z = (1.0 - first * first * second * r_squared) / (first * root + 1.0 - first);
      return Eigen::Vector3d(v.x(), v.y(), z).normalized();
    }
    case Projection::double_sphere: {
      const double root = std::sqrt(1.0 - (2.0 * second - 1.0) * r_squared);
      const double z = (1.0 - second * second * r_squared) / (second * root + 1.0 - second);
      const double scale = (z * first + std::sqrt(z * z + (1.0 - first * first) * r_squared)) / (z * z + r_squared);
      return Eigen::Vector3d(scale * v.x(), scale * v.y(), scale * z - first).normalized();
    }
    case Projection::arctangent: {
      const double distorted = v.norm();
      const double twice_tangent = 2.0 * std::tan(0.5 * first);
      const double ratio =
          distorted < 1e-12 ? first / twice_tangent : std::tan(distorted * first) / (twice_tangent * distorted);
      return (ratio * v).homogeneous().normalized();
    }
  }
  return v.homogeneous().normalized();
}

}  // namespace

std::string_view to_string(CameraModel model) {
  return name_among<CameraModel::thin_prism_fisheye>(
      {"pinhole", "radial_tangential", "equidistant", "rational", "unified", "extended_unified", "double_sphere",
       "field_of_view", "thin_prism_fisheye"},
      model);
}

std::optional<Eigen::Vector2d> Camera::project(const Eigen::Vector3d& point_in_camera) const {
  if (!(point_in_camera.z() > 0.0)) return std::nullopt;
  const Lens lens = lens_of(*this);
  const Eigen::Vector2d ideal = to_plane(lens, point_in_camera);
  if (!is_in_field(lens, ideal.squaredNorm())) return std::nullopt;
  Eigen::Vector2d distorted = distort(lens, ideal);
  if (is_tilted(lens)) distorted = (tilt_homography(lens.tilt) * distorted.homogeneous()).hnormalized();
  return Eigen::Vector2d(fx * distorted.x() + cx, fy * distorted.y() + cy);
}

std::optional<Eigen::Vector3d> Camera::bearing(const Eigen::Vector2d& pixel) const {
  const Lens lens = lens_of(*this);
  Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  if (is_tilted(lens)) distorted = (tilt_homography(lens.tilt).inverse() * distorted.homogeneous()).hnormalized();
  const std::optional<Eigen::Vector2d> ideal = undistort(lens, distorted);
  if (!ideal) return std::nullopt;
  const Eigen::Vector3d direction = to_direction(lens, *ideal);
  return direction.allFinite() ? std::optional(direction) : std::nullopt;
}

bool Camera::contains(const Eigen::Vector2d& pixel) const {
  return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width - 1 && pixel.y() <= height - 1;
}

}  // namespace byre
