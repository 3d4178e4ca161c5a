#include "byre/optimise/bundle_roles.h"

#include "byre/optimise/reprojection.h"

#include <algorithm>

namespace byre {
namespace {

Eigen::Vector3d point_in_camera(const BundleProblem& problem, const BundleObservation& observation) {
  return problem.poses[observation.pose].camera_from_world * problem.points[observation.point].position_in_world;
}

std::vector<int> observations_in_front(const BundleProblem& problem) {
  std::vector<int> indices;
  indices.reserve(problem.observations.size());
  for (int i = 0; i < static_cast<int>(problem.observations.size()); ++i) {
    if (point_in_camera(problem, problem.observations[i]).z() >= kNearestDepth) indices.push_back(i);
  }
  return indices;
}

bool has_anchor(const BundleProblem& problem) {
  return std::ranges::any_of(problem.poses, &BundlePose::fixed) ||
         std::ranges::any_of(problem.points, &BundlePoint::fixed);
}

Eigen::Vector3d camera_in_world(const BundlePose& pose) {
  return inverse(pose.camera_from_world).translation;
}

// The held pose if it alone fixes the gauge: no disparity, second held pose or fixed point determines the scale.
std::optional<int> only_anchor(const BundleProblem& problem, const BundleRoles& roles) {
  std::optional<int> anchor;
  for (const int i : roles.observations) {
    const BundleObservation& observation = problem.observations[i];
    if (observation.is_stereo() || !roles.point_moves[observation.point]) return std::nullopt;
    if (roles.pose_moves[observation.pose] || anchor == observation.pose) continue;
    if (anchor) return std::nullopt;
    anchor = observation.pose;
  }
  return anchor;
}

// Motions between two observed poses, not both fixed. An unobserved pose does not move, so its motions carry no
// information.
std::vector<int> active_motions(const BundleProblem& problem, const BundleRoles& roles,
                                const std::vector<bool>& is_observed) {
  std::vector<int> indices;
  for (int i = 0; i < static_cast<int>(problem.motions.size()); ++i) {
    const BundleMotion& motion = problem.motions[i];
    const bool is_between_observed = is_observed[motion.earlier] && is_observed[motion.later];
    if (is_between_observed && (roles.pose_moves[motion.earlier] || roles.pose_moves[motion.later])) {
      indices.push_back(i);
    }
  }
  return indices;
}

}  // namespace

BundleRoles choose_roles(const BundleProblem& problem) {
  BundleRoles roles{std::vector<bool>(problem.poses.size(), false),
                    std::vector<bool>(problem.points.size(), false),
                    observations_in_front(problem),
                    {}};
  std::vector<bool> is_observed(problem.poses.size(), false);
  for (const int i : roles.observations) {
    const BundleObservation& observation = problem.observations[i];
    is_observed[observation.pose] = true;
    roles.pose_moves[observation.pose] = !problem.poses[observation.pose].fixed;
    roles.point_moves[observation.point] = !problem.points[observation.point].fixed;
  }
  if (!has_anchor(problem)) {
    const auto first = std::ranges::find(roles.pose_moves, true);
    if (first != roles.pose_moves.end()) *first = false;
  }
  std::erase_if(roles.observations, [&](int i) { return !roles.moves(problem.observations[i]); });
  roles.motions = active_motions(problem, roles, is_observed);
  // Points are eliminated one by one.
  std::ranges::stable_sort(roles.observations, {}, [&](int i) { return problem.observations[i].point; });
  return roles;
}

std::optional<FixedDistance> choose_scale(const BundleProblem& problem, const BundleRoles& roles) {
  const auto anchor = only_anchor(problem, roles);
  if (!anchor || !roles.motions.empty()) return std::nullopt;
  FixedDistance held{-1, camera_in_world(problem.poses[*anchor]), 0.0};
  for (std::size_t i = 0; i < problem.poses.size(); ++i) {
    if (!roles.pose_moves[i]) continue;
    const double distance = (camera_in_world(problem.poses[i]) - held.place_in_world).norm();
    if (distance <= held.distance) continue;
    held.distance = distance;
    held.pose = static_cast<int>(i);
  }
  return held.pose < 0 ? std::nullopt : std::optional(held);
}

}  // namespace byre
