#include "byre/optimise/pose_refinement.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/image_regions.h"
#include "byre/geometry/median.h"
#include "byre/optimise/pose_expansion.h"
#include "byre/optimise/robust_error.h"
#include "byre/optimise/rotation_jacobian.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace byre {

namespace {

// An observation in the solver's form.
struct Sighting {
  Eigen::Vector3d point_in_world;
  StereoPixel measured;
  Eigen::Matrix3d information;  // inverse covariance, 1 / pixels^2; third row and column zero without a disparity
  double weight;
  double squared_error;  // squared sigmas; infinite at or behind the camera, or if not a number
  bool tolerated;        // within the gate, once the systematic sigma is added
  bool stereo;
  bool inlier;
};

// A prior in the solver's form.
struct KnownPose {
  Pose world_from_camera;
  Matrix6 information;
};

std::optional<KnownPose> known_pose(const std::optional<PosePrior>& prior) {
  if (!prior) return std::nullopt;
  return KnownPose{inverse(prior->camera_from_world), prior->covariance.inverse()};
}

// Cost of the prior: a residual of six numbers, log_pose(camera_from_world * world_from_camera).
PoseExpansion expand(const KnownPose& known, const Pose& camera_from_world) {
  const Vector6 error = log_pose(camera_from_world * known.world_from_camera);
  Matrix6 jacobian = Matrix6::Identity();
  jacobian.topRightCorner<3, 3>() = -skew(error.head<3>());
  jacobian.bottomRightCorner<3, 3>() = inverse_left_jacobian(error.tail<3>());
  const Matrix6 gain = jacobian.transpose() * known.information;
  return {error.dot(known.information * error), gain * jacobian, -gain * error};
}

// Covariance of the measurement plus that of the point, projected; square pixels.
Eigen::Matrix3d residual_covariance(const PoseObservation& observation, const StereoJacobian& by_point) {
  const double pixel_variance = observation.pixel_sigma * observation.pixel_sigma;
  const double disparity_variance = observation.disparity_sigma * observation.disparity_sigma;
  Eigen::Matrix3d covariance = by_point * observation.point_covariance * by_point.transpose();
  covariance.diagonal() += Eigen::Vector3d(pixel_variance, pixel_variance, disparity_variance);
  return covariance;
}

Eigen::Matrix3d information_of(const Eigen::Matrix3d& covariance, bool stereo) {
  if (stereo) return covariance.inverse();
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  information.topLeftCorner<2, 2>() = covariance.topLeftCorner<2, 2>().inverse();
  return information;
}

// Bound of inliers, squared sigmas.
double gate_of(bool stereo) {
  return stereo ? kMaxSquaredErrorStereo : kMaxSquaredErrorMono;
}

Sighting sight(const PoseObservation& observation, const Rig& rig, const Pose& camera_from_world,
               const Eigen::Matrix3d& rotation, double systematic_sigma) {
  const bool stereo = observation.is_stereo();
  assert(rig.is_stereo() || !stereo);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Sighting sighting{observation.point_in_world,
                    observation.measured,
                    Eigen::Matrix3d::Zero(),
                    observation.weight,
                    kInfinity,
                    false,
                    stereo,
                    false};
  if (!stereo) sighting.measured.z() = 0.0;
  const Eigen::Vector3d point_in_camera = rotation * observation.point_in_world + camera_from_world.translation;
  if (point_in_camera.z() <= 0.0) return sighting;
  Eigen::Matrix3d covariance = residual_covariance(observation, rig.projection_jacobian(point_in_camera) * rotation);
  sighting.information = information_of(covariance, stereo);
  const Eigen::Vector3d error = sighting.measured - rig.project(point_in_camera);
  const double squared_error = error.dot(sighting.information * error);
  if (!std::isfinite(squared_error)) return sighting;
  sighting.squared_error = squared_error;
  sighting.tolerated = squared_error <= gate_of(stereo);
  if (!sighting.tolerated) {
    covariance.diagonal().array() += systematic_sigma * systematic_sigma;
    sighting.tolerated = error.dot(information_of(covariance, stereo) * error) <= gate_of(stereo);
  }
  sighting.inlier = true;
  return sighting;
}

using Sightings = ScratchVector<Sighting>;

// Evaluates all observations at this pose; all in front of the camera become inliers.
Sightings sight(std::span<const PoseObservation> observations, const Rig& rig, const Pose& camera_from_world,
                double systematic_sigma) {
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  Sightings sightings;
  sightings.reserve(observations.size());
  for (const PoseObservation& observation : observations) {
    sightings.push_back(sight(observation, rig, camera_from_world, rotation, systematic_sigma));
  }
  return sightings;
}

// Uses the median of the finite squared errors, which tolerates up to half of them as outliers.
double variance_factor(const Sightings& sightings) {
  constexpr double kMedianMono = 1.386;    // median of chi-square with two degrees of freedom
  constexpr double kMedianStereo = 2.366;  // median of chi-square with three degrees of freedom
  ScratchVector<double> ratios;
  ratios.reserve(sightings.size());
  for (const Sighting& sighting : sightings) {
    if (!std::isfinite(sighting.squared_error)) continue;
    ratios.push_back(sighting.squared_error / (sighting.stereo ? kMedianStereo : kMedianMono));
  }
  return ratios.empty() ? 1.0 : std::max(1.0, median_of(std::span(ratios)));
}

void choose_inliers(Sightings& sightings, double factor) {
  for (Sighting& sighting : sightings) {
    sighting.inlier = sighting.tolerated || sighting.squared_error <= gate_of(sighting.stereo) * factor;
  }
}

int count_inliers(const Sightings& sightings) {
  return static_cast<int>(std::ranges::count(sightings, true, &Sighting::inlier));
}

void gather_inliers(const Sightings& sightings, WeightedPoints& points) {
  points.clear();
  points.reserve(sightings.size());
  for (const Sighting& sighting : sightings) {
    if (sighting.inlier)
      points.add({sighting.point_in_world, sighting.measured, sighting.information, sighting.weight});
  }
}

// Terms of the pose's cost.
struct Evidence {
  const Rig& rig;
  const WeightedPoints& points;
  const std::optional<KnownPose>& known;
  double huber_width;

  PoseExpansion expand_at(const Pose& camera_from_world) const {
    PoseExpansion sum = points.expand(rig, camera_from_world, huber_width);
    if (known) sum += expand(*known, camera_from_world);
    return sum;
  }
};

// Gauss-Newton, damped (Levenberg-Marquardt) after a step that increases the cost.
Pose descend(const Evidence& evidence, Pose camera_from_world, int iterations) {
  constexpr double kConverged = 1e-4;  // squared sigmas
  double damping = 0.0;
  PoseExpansion here = evidence.expand_at(camera_from_world);
  for (int i = 0; i < iterations; ++i) {
    Matrix6 damped = here.normal_matrix;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 delta = damped.ldlt().solve(here.descent);
    const Pose candidate = exp_pose(delta) * camera_from_world;
    const PoseExpansion there = evidence.expand_at(candidate);
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

// Empty if a direction is not determined.
std::optional<Matrix6> inverse_of(const Matrix6& normal_matrix) {
  constexpr double kSingular = 1e-10;  // smallest eigenvalue of the matrix scaled to a unit diagonal
  const Vector6 scale = normal_matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6 scaled = scale.asDiagonal() * normal_matrix * scale.asDiagonal();
  const auto [values, vectors] = symmetric_eigen(scaled);
  if (!(values[0] > kSingular)) return std::nullopt;
  const Matrix6 scaled_inverse = vectors * values.cwiseInverse().asDiagonal() * vectors.transpose();
  return scale.asDiagonal() * scaled_inverse * scale.asDiagonal();
}

// Sums over the inliers of an image region.
struct Region {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();  // inverse covariance of an error shared by all
  Eigen::Vector3d descent = Eigen::Vector3d::Zero();      // information * the shared error
  Eigen::Matrix<double, 6, 3> by_error = Eigen::Matrix<double, 6, 3>::Zero();  // pose's gradient by the error
  int points = 0;
};

using Regions = ByImageRegion<Region>;

Regions gather_regions(const Sightings& sightings, const Rig& rig, const Pose& camera_from_world, double huber_width) {
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  Regions regions;
  for (const Sighting& sighting : sightings) {
    if (!sighting.inlier) continue;
    const Eigen::Vector3d point_in_camera = rotation * sighting.point_in_world + camera_from_world.translation;
    const Eigen::Vector3d error = sighting.measured - rig.project(point_in_camera);
    Region& region = regions[image_region_of(sighting.measured.x(), sighting.measured.y(), rig)];
    const Eigen::Matrix3d information = huber_weight(sighting.squared_error, huber_width) * sighting.information;
    const Eigen::Matrix3d push = sighting.weight * rig.projection_jacobian(point_in_camera).transpose() * information;
    region.information += information;
    region.descent += information * error;
    region.by_error.topRows<3>() += push;
    region.by_error.bottomRows<3>() -= push.colwise().cross(point_in_camera);
    ++region.points;
  }
  return regions;
}

// Estimates the systematic sigma, pixels, from mean errors of regions beyond noise. The prior counts as one region.
double systematic_sigma_of(const Regions& regions, double variance_factor, double prior) {
  constexpr int kMinPoints = 4;         // fewest inliers of a region to count
  constexpr double kPriorValues = 2.0;  // weight of the prior: u and v of one region
  constexpr double kPoseFreedom = 6.0;  // degrees of freedom that the pose takes from the regions' errors
  double excess = 0.0;
  double values = -kPoseFreedom;
  for (const Region& region : regions) {
    if (region.points < kMinPoints) continue;
    const Eigen::Matrix2d covariance = region.information.topLeftCorner<2, 2>().inverse();
    excess += (covariance * region.descent.head<2>()).squaredNorm() - variance_factor * covariance.trace();
    values += 2.0;
  }
  values = std::max(0.0, values);
  const double variance = (kPriorValues * prior * prior + std::max(0.0, excess)) / (kPriorValues + values);
  return std::sqrt(variance);
}

// Covariance of the pose by an independent error in each region, with sigma in pixels.
Matrix6 systematic_covariance(const Regions& regions, const Matrix6& inverse_normal_matrix, double sigma) {
  Matrix6 pushes = Matrix6::Zero();
  for (const Region& region : regions) pushes += region.by_error * region.by_error.transpose();
  return sigma * sigma * inverse_normal_matrix * pushes * inverse_normal_matrix;
}

// Empty if inliers and prior leave a direction undetermined. points: reused memory.
std::optional<PoseRefinement> with_covariance(PoseRefinement refined, const Sightings& sightings,
                                              const std::optional<KnownPose>& known, const Rig& rig,
                                              const PoseRefinementOptions& options, WeightedPoints& points) {
  const Pose& pose = refined.camera_from_world;
  const double huber_width = options.huber_width * std::sqrt(refined.variance_factor);
  gather_inliers(sightings, points);
  const Evidence evidence{rig, points, known, huber_width};
  const std::optional<Matrix6> inverse = inverse_of(evidence.expand_at(pose).normal_matrix);
  if (!inverse) return std::nullopt;
  // Weights are priorities, not accuracies: the covariance is inverse(N) M inverse(N), M being N with squared weights.
  points.square_weights();
  Matrix6 squared = refined.variance_factor * points.expand(rig, pose, huber_width).normal_matrix;
  if (known) squared += expand(*known, pose).normal_matrix;
  refined.covariance = *inverse * squared * *inverse;
  if (options.systematic_sigma <= 0.0) return refined;
  const Regions regions = gather_regions(sightings, rig, pose, huber_width);
  refined.systematic_sigma = systematic_sigma_of(regions, refined.variance_factor, options.systematic_sigma);
  refined.covariance += systematic_covariance(regions, *inverse, refined.systematic_sigma);
  return refined;
}

}  // namespace

std::optional<PoseRefinement> refine_pose(const Pose& predicted_camera_from_world, const Rig& rig,
                                          std::span<const PoseObservation> observations,
                                          const PoseRefinementOptions& options, const std::optional<PosePrior>& prior) {
  constexpr int kMinInliers = 4;
  const std::optional<KnownPose> known = known_pose(prior);
  PoseRefinement result;
  result.camera_from_world = predicted_camera_from_world;
  Sightings sightings = sight(observations, rig, predicted_camera_from_world, options.systematic_sigma);
  WeightedPoints inliers;
  // Far from the solution all errors are large. Gates and loss follow the decrease of their median, so that a minority
  // that fits by chance does not capture the pose.
  for (int round = 0; round < options.rounds; ++round) {
    const double factor = variance_factor(sightings);
    choose_inliers(sightings, factor);
    if (count_inliers(sightings) < kMinInliers) return std::nullopt;
    gather_inliers(sightings, inliers);
    const Evidence evidence{rig, inliers, known, options.huber_width * std::sqrt(factor)};
    result.camera_from_world = descend(evidence, result.camera_from_world, options.iterations_per_round);
    sightings = sight(observations, rig, result.camera_from_world, options.systematic_sigma);
  }
  result.variance_factor = std::min(variance_factor(sightings), options.max_variance_factor);
  choose_inliers(sightings, result.variance_factor);
  result.inlier_count = count_inliers(sightings);
  if (result.inlier_count < kMinInliers) return std::nullopt;
  result.inliers.reserve(sightings.size());
  for (const Sighting& sighting : sightings) result.inliers.push_back(sighting.inlier);
  return with_covariance(std::move(result), sightings, known, rig, options, inliers);
}

}  // namespace byre
