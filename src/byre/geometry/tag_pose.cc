#include "byre/geometry/tag_pose.h"

#include "byre/geometry/homography.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace byre {
namespace {

constexpr double kPixelSigma = 0.3;  // pixels, of a corner
constexpr double kHuber = 1.0;       // pixels
constexpr double kMaxError = 3.0;    // pixels, root mean square of a view that agrees

struct NormalEquations {
  Matrix6 hessian = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
  double cost = 0.0;     // square pixels, with Huber's loss
  double squares = 0.0;  // square pixels, of the views that agree
  int views = 0;         // views that agree
};

NormalEquations normal_equations(std::span<const TagView> views, const Pose& world_from_tag, double size) {
  NormalEquations sum;
  const auto in_tag = tag_corners(size);
  for (const TagView& view : views) {
    const Pose camera_from_tag = view.camera_from_world * world_from_tag;
    const Eigen::Matrix3d rotation = camera_from_tag.rotation.toRotationMatrix();
    double squares = 0.0;
    for (std::size_t i = 0; i < in_tag.size(); ++i) {
      const Eigen::Vector3d in_camera = camera_from_tag * in_tag[i];
      if (!(in_camera.z() > 1e-3 * size)) {
        sum.cost = std::numeric_limits<double>::infinity();
        return sum;
      }
      const Eigen::Vector2d residual = view.rig.project(in_camera).head<2>() - view.corners[i];
      Eigen::Matrix<double, 3, 6> moved;
      moved << rotation, -rotation * skew(in_tag[i]);
      const Eigen::Matrix<double, 2, 6> jacobian = view.rig.projection_jacobian(in_camera).topRows<2>() * moved;
      const double length = residual.norm();
      const double weight = length <= kHuber ? 1.0 : kHuber / length;
      sum.hessian += weight * jacobian.transpose() * jacobian;
      sum.gradient += weight * jacobian.transpose() * residual;
      sum.cost += length <= kHuber ? length * length : kHuber * (2.0 * length - kHuber);
      squares += length * length;
    }
    if (squares > 4.0 * kMaxError * kMaxError) continue;
    sum.squares += squares;
    ++sum.views;
  }
  return sum;
}

// Levenberg-Marquardt.
std::optional<TagEstimate> refine(std::span<const TagView> views, Pose world_from_tag, double size) {
  constexpr int kIterations = 30;
  constexpr double kSmallStep = 1e-8;  // metres and radians
  NormalEquations now = normal_equations(views, world_from_tag, size);
  double damping = 1e-4;
  for (int i = 0; i < kIterations && std::isfinite(now.cost); ++i) {
    Matrix6 damped = now.hessian;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 delta = -damped.ldlt().solve(now.gradient);
    if (!delta.allFinite()) return std::nullopt;
    const Pose moved = world_from_tag * exp_pose(delta);
    const NormalEquations next = normal_equations(views, moved, size);
    if (next.cost <= now.cost) {
      world_from_tag = moved;
      now = next;
      damping *= 0.1;
      if (delta.norm() < kSmallStep) break;
    } else {
      damping *= 10.0;
    }
  }
  const auto most = static_cast<double>(views.size()) / 2.0;
  if (!std::isfinite(now.cost) || now.views <= most) return std::nullopt;
  const Eigen::LDLT<Matrix6> solver(now.hessian);
  const double error = std::sqrt(now.squares / (4.0 * now.views));
  const double sigma = std::max(kPixelSigma, error);
  const Matrix6 covariance = sigma * sigma * solver.solve(Matrix6::Identity());
  if (!solver.isPositive() || !covariance.allFinite()) return std::nullopt;
  return TagEstimate{world_from_tag, 0.5 * (covariance + covariance.transpose()), error, now.views};
}

// Pose camera_from_tag by the homography from the tag's plane to the image.
std::optional<Pose> pose_by_homography(const TagView& view, double size) {
  std::vector<TwoViewMatch> matches;
  const auto in_tag = tag_corners(size);
  for (std::size_t i = 0; i < in_tag.size(); ++i) {
    matches.push_back({Eigen::Vector3d(in_tag[i].x(), in_tag[i].y(), 1.0), view.rig.ray(view.corners[i])});
  }
  const auto homography = fit_homography(matches);
  if (!homography) return std::nullopt;
  Eigen::Matrix3d columns = *homography / std::sqrt(homography->col(0).norm() * homography->col(1).norm());
  if (columns(2, 2) < 0.0) columns = -columns;
  Eigen::Matrix3d rotation;
  rotation << columns.col(0), columns.col(1), columns.col(0).cross(columns.col(1));
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  if (!nearest.allFinite() || nearest.determinant() < 0.0) return std::nullopt;
  return Pose{Eigen::Quaterniond(nearest).normalized(), columns.col(2)};
}

// The tag mirrored about the viewing ray: the same picture but for perspective.
Pose flipped(const Pose& camera_from_tag) {
  const Eigen::Vector3d ray = camera_from_tag.translation.normalized();
  const Eigen::Vector3d normal = camera_from_tag.rotation * Eigen::Vector3d::UnitZ();
  const Eigen::Vector3d mirrored = 2.0 * ray.dot(normal) * ray - normal;
  return {Eigen::Quaterniond::FromTwoVectors(normal, mirrored) * camera_from_tag.rotation, camera_from_tag.translation};
}

bool is_same(const TagEstimate& one, const TagEstimate& other) {
  constexpr double kTurn = 0.02;  // radians
  return angle_between(one.world_from_tag.rotation, other.world_from_tag.rotation) < kTurn;
}

// The corners do not exclude the second pose: chi-square test of the difference between the squared errors.
bool is_ambiguous(const TagEstimate& best, const TagEstimate& second) {
  constexpr double kSigmas = 5.0;
  const double sigma = std::max(kPixelSigma, best.error);
  const double difference = 4.0 * best.views * (second.error * second.error - best.error * best.error);
  return second.views == best.views && difference < kSigmas * kSigmas * sigma * sigma;
}

}  // namespace

std::array<Eigen::Vector3d, 4> tag_corners(double size) {
  const double half = 0.5 * size;
  return {{{-half, -half, 0.0}, {half, -half, 0.0}, {half, half, 0.0}, {-half, half, 0.0}}};
}

std::vector<TagEstimate> estimate_tag_pose(std::span<const TagView> views, double size) {
  constexpr std::size_t kStarts = 5;  // views whose own poses are refined by all views
  const std::size_t step = std::max<std::size_t>(1, views.size() / kStarts);
  std::vector<TagEstimate> estimates;
  for (std::size_t i = 0; i < views.size(); i += step) {
    const auto seen = pose_by_homography(views[i], size);
    if (!seen) continue;
    for (const Pose& camera_from_tag : {*seen, flipped(*seen)}) {
      auto estimate = refine(views, inverse(views[i].camera_from_world) * camera_from_tag, size);
      const auto is_known = [&](const TagEstimate& known) { return is_same(known, *estimate); };
      if (estimate && std::ranges::none_of(estimates, is_known)) estimates.push_back(*estimate);
    }
  }
  std::ranges::stable_sort(estimates, {}, [](const TagEstimate& each) { return std::pair(-each.views, each.error); });
  if (estimates.size() > 2) estimates.resize(2);
  if (estimates.size() == 2 && !is_ambiguous(estimates[0], estimates[1])) estimates.pop_back();
  return estimates;
}

// Position X of the tag and unit s: X - s * (distance vector in metres) = camera centre, for each view.
std::optional<UnitEstimate> estimate_unit(std::span<const TagView> views, double size) {
  constexpr double kMaxSigma = 0.05;
  constexpr double kSigmaOfCorners = 0.01;  // common relative error of sizes in images, by blur
  constexpr double kMaxSquares = 9.0;       // mean square of the residuals, in sigmas
  Eigen::Matrix4d hessian = Eigen::Matrix4d::Zero();
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  double squares = 0.0;
  int count = 0;
  for (const TagView& view : views) {
    const TagView alone{{}, view.rig, view.corners};
    const auto seen = estimate_tag_pose(std::span(&alone, 1), size);
    if (seen.empty()) continue;
    const Pose world_from_camera = inverse(view.camera_from_world);
    const Eigen::Matrix3d turn = (world_from_camera.rotation * seen[0].world_from_tag.rotation).toRotationMatrix();
    const Eigen::Matrix3d covariance = turn * seen[0].covariance.topLeftCorner<3, 3>() * turn.transpose();
    const Eigen::Matrix3d information = covariance.ldlt().solve(Eigen::Matrix3d::Identity());
    Eigen::Matrix<double, 3, 4> jacobian;
    jacobian << Eigen::Matrix3d::Identity(), -(world_from_camera.rotation * seen[0].world_from_tag.translation);
    const Eigen::Vector3d& centre = world_from_camera.translation;
    hessian += jacobian.transpose() * information * jacobian;
    gradient += jacobian.transpose() * information * centre;
    squares += centre.dot(information * centre);
    ++count;
  }
  if (count < 2) return std::nullopt;
  const Eigen::LDLT<Eigen::Matrix4d> solver(hessian);
  const Eigen::Vector4d solution = solver.solve(gradient);
  const double unit = solution[3];
  if (!solver.isPositive() || !solution.allFinite() || !(unit > 0.0)) return std::nullopt;
  const double variance = solver.solve(Eigen::Vector4d::UnitW())[3];
  const double mean_square = (squares - gradient.dot(solution)) / (unit * unit * (3.0 * count - 4.0));
  const double sigma = std::hypot(kSigmaOfCorners, std::sqrt(variance * std::max(1.0, mean_square)));
  if (!(mean_square <= kMaxSquares) || !(sigma <= kMaxSigma)) return std::nullopt;
  return UnitEstimate{unit, sigma};
}

}  // namespace byre
