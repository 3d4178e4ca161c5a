#include "byre/optimise/bundle_adjustment.h"

#include "byre/optimise/bundle_covariance.h"
#include "byre/optimise/bundle_roles.h"
#include "byre/optimise/bundle_schur.h"

#include <limits>
#include <utility>

namespace byre {

namespace {

BundleResult unchanged_result(const BundleProblem& problem) {
  BundleResult result;
  result.camera_from_world.reserve(problem.poses.size());
  result.points_in_world.reserve(problem.points.size());
  for (const BundlePose& pose : problem.poses) result.camera_from_world.push_back(pose.camera_from_world);
  for (const BundlePoint& point : problem.points) result.points_in_world.push_back(point.position_in_world);
  result.usable = true;
  return result;
}

BundleResult solve(const BundleProblem& problem, const BundleRoles& roles, const std::optional<FixedDistance>& scale,
                   const BundleOptions& options) {
  if (roles.observations.empty()) return unchanged_result(problem);
  BundleSolution solution = solve_bundle(problem, roles, scale, options);
  BundleResult result;
  if (!solution.usable) result = unchanged_result(problem);
  result.iterations = solution.iterations;
  result.usable = solution.usable;
  if (!result.usable) return result;
  result.calibration_change = solution.calibration_change;
  result.pose_covariances = std::move(solution.pose_covariances);
  result.camera_from_world = std::move(solution.camera_from_world);
  result.points_in_world = std::move(solution.points_in_world);
  return result;
}

// The problem at its solution; a pose held in place of an anchor becomes fixed.
BundleProblem moved(BundleProblem problem, const BundleResult& result, const BundleRoles& roles) {
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    problem.poses[i].camera_from_world = result.camera_from_world[i];
    problem.poses[i].fixed = !roles.pose_moves[i];
  }
  for (std::size_t i = 0; i < problem.points.size(); ++i) {
    problem.points[i].position_in_world = result.points_in_world[i];
  }
  return problem;
}

double squared_error(const BundleObservation& observation, const Rig& rig, const Eigen::Vector3d& point_in_camera) {
  if (point_in_camera.z() <= 0.0) return std::numeric_limits<double>::infinity();
  const StereoPixel error = rig.project(point_in_camera) - observation.measured;
  const double pixels = error.head<2>().squaredNorm() / (observation.pixel_sigma * observation.pixel_sigma);
  if (!observation.is_stereo()) return pixels;
  return pixels + error.z() * error.z() / (observation.disparity_sigma * observation.disparity_sigma);
}

std::vector<double> squared_errors(const BundleProblem& problem, const BundleResult& result) {
  std::vector<double> errors;
  errors.reserve(problem.observations.size());
  for (const BundleObservation& observation : problem.observations) {
    const Rig& rig = problem.rigs[problem.poses[observation.pose].rig];
    errors.push_back(squared_error(
        observation, rig, result.camera_from_world[observation.pose] * result.points_in_world[observation.point]));
  }
  return errors;
}

}  // namespace

BundleProblem with_change(BundleProblem problem, const CalibrationVector& change) {
  if (!problem.calibration) return problem;
  for (BundleObservation& observation : problem.observations) {
    if (problem.poses[observation.pose].rig != problem.calibration->rig) continue;
    const Eigen::Vector3d shift = problem.calibration->sensitivity->at(observation.measured).topRows<3>() * change;
    observation.measured.head<2>() -= shift.head<2>();
    if (observation.is_stereo()) observation.measured.z() -= shift.z();
  }
  problem.calibration.reset();
  return problem;
}

BundleResult bundle_adjust(const BundleProblem& problem, const BundleOptions& options) {
  const BundleRoles roles = choose_roles(problem);
  const std::optional<FixedDistance> scale = choose_scale(problem, roles);
  BundleResult result = solve(problem, roles, scale, options);
  std::optional<BundleProblem> changed;
  if (problem.calibration) changed = with_change(problem, result.calibration_change);
  const BundleProblem& calibrated = changed ? *changed : problem;
  result.squared_errors = squared_errors(calibrated, result);
  if (options.covariance_of_pose >= 0 && result.usable) {
    result.pose_covariance =
        marginal_covariance(with_shared_errors(moved(calibrated, result, roles), options.systematic_sigma), scale,
                            options.covariance_of_pose, options.huber_width);
  }
  return result;
}

}  // namespace byre
