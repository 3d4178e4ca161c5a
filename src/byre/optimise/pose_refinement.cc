#include "byre/optimise/pose_refinement.h"

#include "byre/geometry/median.h"
#include "byre/optimise/huber.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>

namespace byre {

namespace {

// An observation as the solver reads it.
struct Sighting {
  Eigen::Vector3d point_in_world;
  StereoPixel measured;
  Eigen::Matrix3d information;  // of the residual in pixels; without a disparity its third row and column are zero
  double weight;
  double squared_error;  // squared sigmas; infinite at or behind the camera, or when not a number
  bool stereo;
  bool inlier;
};

// The weighted cost, and its expansion to second order in delta.
struct Expansion {
  double cost = 0.0;  // squared sigmas
  Matrix6 normal_matrix = Matrix6::Zero();
  Vector6 descent = Vector6::Zero();  // minus half the gradient

  // Adds a term given by its derivatives by the point in the camera, which moves by translation + rotation x point.
  void add(const Eigen::Matrix3d& camera_matrix, const Eigen::Vector3d& camera_descent,
           const Eigen::Vector3d& point_in_camera) {
    const Eigen::Matrix3d turned = -camera_matrix.colwise().cross(point_in_camera);
    normal_matrix.topLeftCorner<3, 3>() += camera_matrix;
    normal_matrix.bottomLeftCorner<3, 3>() += turned;
    normal_matrix.bottomRightCorner<3, 3>() -= turned.rowwise().cross(point_in_camera.transpose());
    descent.head<3>() += camera_descent;
    descent.tail<3>() += point_in_camera.cross(camera_descent);
  }
};

// Of the residual: the inverse of the measurement's covariance plus the point's, projected.
Eigen::Matrix3d residual_information(const PoseObservation& observation, const StereoJacobian& by_point) {
  const double pixel_variance = observation.pixel_sigma * observation.pixel_sigma;
  const double disparity_variance = observation.disparity_sigma * observation.disparity_sigma;
  Eigen::Matrix3d covariance = by_point * observation.point_covariance * by_point.transpose();
  covariance.diagonal() += Eigen::Vector3d(pixel_variance, pixel_variance, disparity_variance);
  if (observation.is_stereo()) return covariance.inverse();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>().inverse();
  return information;
}

Sighting sight(const PoseObservation& observation, const Rig& rig, const Pose& camera_from_world,
               const Eigen::Matrix3d& rotation) {
  const bool stereo = observation.is_stereo();
  assert(rig.is_stereo() || !stereo);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Sighting sighting{observation.point_in_world,
                    observation.measured,
                    Eigen::Matrix3d::Zero(),
                    observation.weight,
                    kInfinity,
                    stereo,
                    false};
  if (!stereo) sighting.measured.z() = 0.0;
  const Eigen::Vector3d point_in_camera = rotation * observation.point_in_world + camera_from_world.translation;
  if (point_in_camera.z() <= 0.0) return sighting;
  sighting.information = residual_information(observation, rig.projection_jacobian(point_in_camera) * rotation);
  const Eigen::Vector3d error = sighting.measured - rig.project(point_in_camera);
  const double squared_error = error.dot(sighting.information * error);
  if (!std::isfinite(squared_error)) return sighting;
  sighting.squared_error = squared_error;
  sighting.inlier = true;
  return sighting;
}

// Weighs all observations anew at this pose; all in front of the camera are inliers so far.
std::vector<Sighting> sight(std::span<const PoseObservation> observations, const Rig& rig,
                            const Pose& camera_from_world) {
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  std::vector<Sighting> sightings;
  sightings.reserve(observations.size());
  for (const PoseObservation& observation : observations) {
    sightings.push_back(sight(observation, rig, camera_from_world, rotation));
  }
  return sightings;
}

// From the median of the finite squared errors, so that up to half of them may be outliers.
double variance_factor(const std::vector<Sighting>& sightings) {
  constexpr double kMedianMono = 1.386;    // of chi-square with two degrees of freedom
  constexpr double kMedianStereo = 2.366;  // three
  std::vector<double> ratios;
  ratios.reserve(sightings.size());
  for (const Sighting& sighting : sightings) {
    if (!std::isfinite(sighting.squared_error)) continue;
    ratios.push_back(sighting.squared_error / (sighting.stereo ? kMedianStereo : kMedianMono));
  }
  return ratios.empty() ? 1.0 : std::max(1.0, median(std::move(ratios)));
}

void choose_inliers(std::vector<Sighting>& sightings, const PoseRefinementOptions& options, double factor) {
  for (Sighting& sighting : sightings) {
    const double gate = sighting.stereo ? options.max_squared_error_stereo : options.max_squared_error_mono;
    sighting.inlier = sighting.squared_error <= gate * factor;
  }
}

int count_inliers(const std::vector<Sighting>& sightings) {
  return static_cast<int>(std::ranges::count(sightings, true, &Sighting::inlier));
}

// Over the inliers.
Expansion expand(const std::vector<Sighting>& sightings, const Rig& rig, const Pose& camera_from_world,
                 double huber_width) {
  constexpr double kSquaredErrorBehind = 1e4;  // what a step that moves a point behind the camera pays for it
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  Expansion sum;
  for (const Sighting& sighting : sightings) {
    if (!sighting.inlier) continue;
    const Eigen::Vector3d point_in_camera = rotation * sighting.point_in_world + camera_from_world.translation;
    if (point_in_camera.z() <= 0.0) {
      sum.cost += sighting.weight * huber_cost(kSquaredErrorBehind, huber_width);
      continue;
    }
    const Eigen::Vector3d error = sighting.measured - rig.project(point_in_camera);
    const double squared_error = error.dot(sighting.information * error);
    const double weight = sighting.weight * huber_weight(squared_error, huber_width);
    const StereoJacobian by_camera = rig.projection_jacobian(point_in_camera);
    const Eigen::Matrix3d gain = (weight * by_camera.transpose()) * sighting.information;
    sum.cost += sighting.weight * huber_cost(squared_error, huber_width);
    sum.add(gain * by_camera, gain * error, point_in_camera);
  }
  sum.normal_matrix.topRightCorner<3, 3>() = sum.normal_matrix.bottomLeftCorner<3, 3>().transpose();
  return sum;
}

// Gauss-Newton, damped (Levenberg-Marquardt) after a step that led uphill.
Pose descend(const std::vector<Sighting>& sightings, const Rig& rig, Pose camera_from_world,
             const PoseRefinementOptions& options, double huber_width) {
  constexpr double kConverged = 1e-4;  // squared sigmas
  double damping = 0.0;
  Expansion here = expand(sightings, rig, camera_from_world, huber_width);
  for (int i = 0; i < options.iterations_per_round; ++i) {
    Matrix6 damped = here.normal_matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 delta = damped.ldlt().solve(here.descent);
    const Pose candidate = exp_pose(delta) * camera_from_world;
    const Expansion there = expand(sightings, rig, candidate, huber_width);
    if (!(there.cost <= here.cost)) {
      damping = std::max(10.0 * damping, 1e-2);
      continue;
    }
    const double gain = delta.dot(here.descent);
    camera_from_world = candidate;
    here = there;
    damping *= 0.1;
    if (gain < kConverged) break;
  }
  return camera_from_world;
}

// Empty where a direction is not determined.
std::optional<Matrix6> inverse_of(const Matrix6& normal_matrix) {
  constexpr double kSingular = 1e-10;  // smallest eigenvalue, once the diagonal is scaled to ones
  const Vector6 scale = normal_matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 scaled = scale.asDiagonal() * normal_matrix * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Matrix6> eigen(scaled);
  if (!(eigen.eigenvalues()[0] > kSingular)) return std::nullopt;
  const Matrix6 scaled_inverse =
      eigen.eigenvectors() * eigen.eigenvalues().cwiseInverse().asDiagonal() * eigen.eigenvectors().transpose();
  return scale.asDiagonal() * scaled_inverse * scale.asDiagonal();
}

// Weights set priorities, they do not make measurements better: a weighted estimate's covariance is
// inverse(N) M inverse(N), where M is the normal matrix with the weights squared.
std::optional<Matrix6> covariance_at(std::vector<Sighting> sightings, const Rig& rig, const Pose& camera_from_world,
                                     double huber_width) {
  const Matrix6 normal_matrix = expand(sightings, rig, camera_from_world, huber_width).normal_matrix;
  const std::optional<Matrix6> inverse = inverse_of(normal_matrix);
  if (!inverse) return std::nullopt;
  for (Sighting& sighting : sightings) sighting.weight *= sighting.weight;
  return *inverse * expand(sightings, rig, camera_from_world, huber_width).normal_matrix * *inverse;
}

}  // namespace

std::optional<PoseRefinement> refine_pose(const Pose& predicted_camera_from_world, const Rig& rig,
                                          std::span<const PoseObservation> observations,
                                          const PoseRefinementOptions& options) {
  constexpr int kMinInliers = 4;
  PoseRefinement result;
  result.camera_from_world = predicted_camera_from_world;
  std::vector<Sighting> sightings = sight(observations, rig, predicted_camera_from_world);
  // Far from the solution all errors are large: gates and loss follow their median down, so that no minority that
  // happens to fit captures the pose.
  for (int round = 0; round < options.rounds; ++round) {
    const double factor = variance_factor(sightings);
    choose_inliers(sightings, options, factor);
    if (count_inliers(sightings) < kMinInliers) return std::nullopt;
    result.camera_from_world =
        descend(sightings, rig, result.camera_from_world, options, options.huber_width * std::sqrt(factor));
    sightings = sight(observations, rig, result.camera_from_world);
  }
  result.variance_factor = std::min(variance_factor(sightings), options.max_variance_factor);
  choose_inliers(sightings, options, result.variance_factor);
  result.inlier_count = count_inliers(sightings);
  if (result.inlier_count < kMinInliers) return std::nullopt;
  for (const Sighting& sighting : sightings) result.inliers.push_back(sighting.inlier);
  const auto covariance = covariance_at(std::move(sightings), rig, result.camera_from_world,
                                        options.huber_width * std::sqrt(result.variance_factor));
  if (!covariance) return std::nullopt;
  result.covariance = result.variance_factor * *covariance;
  return result;
}

}  // namespace byre
