#include "byre/geometry/absolute_pose.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/perspective_three_point.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Cholesky>

namespace byre {
namespace {

struct Problem {
  std::span<const PointSighting> sightings;
  const Rig& rig;
  double max_squared_error;  // pixels squared
};

// A pose and its truncated squared error summed over the sightings, pixels squared (MSAC: Torr and Zisserman 2000).
struct Candidate {
  Pose camera_from_world;
  double cost = std::numeric_limits<double>::infinity();
  int inlier_count = 0;
};

// Projected less measured pixel and disparity; the disparity error is zero without a measured disparity.
StereoPixel error_of(const PointSighting& sighting, const StereoPixel& projected) {
  const double disparity = sighting.disparity.value_or(projected.z());
  return projected - StereoPixel(sighting.pixel.x(), sighting.pixel.y(), disparity);
}

// Stops once the cost exceeds cost_to_beat; the candidate's counts are then partial.
Candidate score(const Problem& problem, const Pose& camera_from_world, double cost_to_beat) {
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  Candidate candidate{camera_from_world, 0.0, 0};
  for (const PointSighting& sighting : problem.sightings) {
    const Eigen::Vector3d point_in_camera = rotation * sighting.point_in_world + camera_from_world.translation;
    double squared_error = problem.max_squared_error;
    if (point_in_camera.z() > 0.0) {
      squared_error = error_of(sighting, problem.rig.project(point_in_camera)).squaredNorm();
    }
    const bool inlier = squared_error < problem.max_squared_error;
    candidate.inlier_count += inlier;
    candidate.cost += inlier ? squared_error : problem.max_squared_error;
    if (candidate.cost > cost_to_beat) break;
  }
  return candidate;
}

// Gauss-Newton equations over the inliers of a pose, for a small motion in the camera frame.
struct NormalEquations {
  Matrix6 information = Matrix6::Zero();
  Vector6 gradient = Vector6::Zero();
};

NormalEquations linearise(const Problem& problem, const Pose& camera_from_world) {
  const Eigen::Matrix3d rotation = camera_from_world.rotation.toRotationMatrix();
  NormalEquations equations;
  for (const PointSighting& sighting : problem.sightings) {
    const Eigen::Vector3d point_in_camera = rotation * sighting.point_in_world + camera_from_world.translation;
    if (!(point_in_camera.z() > 0.0)) continue;
    const StereoPixel error = error_of(sighting, problem.rig.project(point_in_camera));
    if (!(error.squaredNorm() < problem.max_squared_error)) continue;
    StereoJacobian by_point = problem.rig.projection_jacobian(point_in_camera);
    if (!sighting.disparity) by_point.row(2).setZero();
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << by_point, by_point * -skew(point_in_camera);
    equations.information.noalias() += jacobian.transpose() * jacobian;
    equations.gradient.noalias() += jacobian.transpose() * error;
  }
  return equations;
}

// Levenberg-Marquardt on the truncated cost; never worse than the start.
Candidate refine(const Problem& problem, Candidate best, int max_steps) {
  constexpr double kConverged = 1e-9;  // relative decrease of the cost
  double damping = 1e-4;
  NormalEquations equations = linearise(problem, best.camera_from_world);
  for (int step = 0; step < max_steps; ++step) {
    Matrix6 damped = equations.information;
    damped.diagonal() *= 1.0 + damping;
    const Vector6 motion = -damped.ldlt().solve(equations.gradient);
    const Candidate trial = score(problem, exp_pose(motion) * best.camera_from_world, best.cost);
    if (!(trial.cost < best.cost)) {
      damping *= 10.0;
      continue;
    }
    const bool converged = best.cost - trial.cost < kConverged * best.cost;
    best = trial;
    if (converged) break;
    damping *= 0.1;
    equations = linearise(problem, best.camera_from_world);
  }
  return best;
}

std::array<std::size_t, 3> draw_three(std::size_t count, std::mt19937_64& random) {
  const auto draw = [&] { return static_cast<std::size_t>(random() % count); };  // draws equal on all platforms
  std::array<std::size_t, 3> drawn{draw(), draw(), draw()};
  while (drawn[1] == drawn[0]) drawn[1] = draw();
  while (drawn[2] == drawn[0] || drawn[2] == drawn[1]) drawn[2] = draw();
  return drawn;
}

std::vector<Pose> poses_from(const Problem& problem, const std::array<std::size_t, 3>& drawn) {
  std::array<Eigen::Vector3d, 3> points_in_world, bearings;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    points_in_world[i] = problem.sightings[drawn[i]].point_in_world;
    bearings[i] = problem.rig.ray(problem.sightings[drawn[i]].pixel).normalized();
  }
  return perspective_three_point(points_in_world, bearings);
}

// Number of draws until one of three inliers has occurred with the wanted confidence (Fischler and Bolles 1981).
int pose_draws_needed(double inlier_ratio, const RansacOptions& options) {
  const double all_inliers = inlier_ratio * inlier_ratio * inlier_ratio;
  if (all_inliers >= 1.0) return 1;
  const double draws = std::log(1.0 - options.confidence) / std::log1p(-all_inliers);
  return static_cast<int>(std::min(std::ceil(draws), static_cast<double>(options.max_iterations)));
}

Candidate search(const Problem& problem, const RansacOptions& options) {
  constexpr int kLocalSteps = 5;
  std::mt19937_64 random(options.seed);
  Candidate best;
  int draws = options.max_iterations;
  for (int i = 0; i < draws; ++i) {
    for (const Pose& pose : poses_from(problem, draw_three(problem.sightings.size(), random))) {
      const Candidate candidate = score(problem, pose, best.cost);
      if (!(candidate.cost < best.cost)) continue;
      best = refine(problem, candidate, kLocalSteps);
      draws = pose_draws_needed(best.inlier_count / static_cast<double>(problem.sightings.size()), options);
    }
  }
  return best;
}

std::vector<bool> inliers_of(const Problem& problem, const Pose& camera_from_world) {
  std::vector<bool> inliers;
  inliers.reserve(problem.sightings.size());
  for (const PointSighting& sighting : problem.sightings) {
    const Problem alone{{&sighting, 1}, problem.rig, problem.max_squared_error};
    inliers.push_back(score(alone, camera_from_world, std::numeric_limits<double>::infinity()).inlier_count == 1);
  }
  return inliers;
}

// Points on one line leave the rotation about it free, however many they are.
bool on_one_line(std::span<const PointSighting> sightings, const std::vector<bool>& chosen) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    if (chosen[i]) sum += sightings[i].point_in_world;
  }
  const Eigen::Vector3d mean = sum / static_cast<double>(std::count(chosen.begin(), chosen.end(), true));
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < sightings.size(); ++i) {
    const Eigen::Vector3d offset = sightings[i].point_in_world - mean;
    if (chosen[i]) covariance += offset * offset.transpose();
  }
  constexpr double kThinnest = 1e-3;  // width over length
  const Eigen::Vector3d squared_widths = symmetric_eigenvalues(covariance);
  return !(squared_widths[1] > kThinnest * kThinnest * squared_widths[2]);
}

}  // namespace

std::optional<AbsolutePose> estimate_absolute_pose(std::span<const PointSighting> sightings, const Rig& rig,
                                                   const RansacOptions& options) {
  constexpr int kFewest = 4;  // three always agree
  constexpr int kFinalSteps = 30;
  if (sightings.size() < kFewest) return std::nullopt;
  const Problem problem{sightings, rig, options.max_error * options.max_error};
  const Candidate best = refine(problem, search(problem, options), kFinalSteps);
  if (best.inlier_count < kFewest) return std::nullopt;
  AbsolutePose result{best.camera_from_world, inliers_of(problem, best.camera_from_world), best.inlier_count};
  if (on_one_line(sightings, result.inliers)) return std::nullopt;
  return result;
}

}  // namespace byre
