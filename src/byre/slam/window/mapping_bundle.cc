#include "byre/optimise/pose_refinement.h"
#include "byre/optimise/robust_error.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <Eigen/LU>

namespace byre {
namespace {

// Bundle problem of a window, with the feature of each observation. Its poses are the window's keyframes, its points
// the window's points.
struct WindowBundle {
  BundleProblem problem;
  std::vector<int> features;

  WindowObservation seen(std::size_t observation) const {
    return {problem.observations[observation].pose, features[observation]};
  }
};

// Adds the covariance of a fixed point to the sigmas of an observation: fixed points are not exact.
void widen(BundleObservation& observation, const MapPoint& point, const Pose& camera_from_world, const Rig& rig) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point.position_in_world;
  if (point_in_camera.z() <= 0.0) return;
  const Eigen::Matrix3d jacobian =
      rig.projection_jacobian(point_in_camera) * camera_from_world.rotation.toRotationMatrix();
  const Eigen::Vector3d variances = (jacobian * point.covariance * jacobian.transpose()).diagonal();
  observation.pixel_sigma = std::hypot(observation.pixel_sigma, std::sqrt(0.5 * (variances.x() + variances.y())));
  if (observation.is_stereo()) {
    observation.disparity_sigma = std::hypot(observation.disparity_sigma, std::sqrt(variances.z()));
  }
}

BundleObservation weighted_observation(const MapWindow& window, const WindowPoint& point, const WindowObservation& seen,
                                       bool is_fixed, double offline_weight) {
  const WindowKeyframe& keyframe = window.keyframe(seen.keyframe);
  BundleObservation observation = bundle_observation(keyframe, seen.feature);
  if (!is_fixed) return observation;
  widen(observation, point.point, keyframe.keyframe.camera_from_world, window.rig_of(keyframe));
  observation.weight = offline_weight;
  return observation;
}

BundleMotion bundle_motion(const MapWindow& window, const WindowMotion& motion) {
  const auto rig_at = [&](int keyframe) { return window.rig_of(window.keyframe(keyframe)).body_from_camera; };
  const Pose earlier_camera_from_body = inverse(rig_at(motion.earlier)),
             camera_from_body = inverse(rig_at(motion.later));
  return {motion.earlier, motion.later,
          camera_from_body * inverse(motion.motion.last_from_body) * inverse(earlier_camera_from_body),
          move_covariance(motion.motion.covariance, camera_from_body).inverse()};
}

// Reserves memory: growing lists would take twice as much in maps with millions of observations.
void reserve_for(const MapWindow& window, WindowBundle& bundle) {
  std::size_t observations = 0;
  for (const WindowPoint& point : window.points) observations += point.observations.size();
  bundle.problem.poses.reserve(window.keyframes.size());
  bundle.problem.points.reserve(window.points.size());
  bundle.problem.observations.reserve(observations);
  bundle.features.reserve(observations);
}

// Anchors' observations of fixed points are left out.
WindowBundle make_bundle(const MapWindow& window, double offline_weight) {
  WindowBundle bundle;
  reserve_for(window, bundle);
  bundle.problem.rigs = window.rigs;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    bundle.problem.poses.push_back({keyframe.keyframe.camera_from_world, keyframe.keyframe.rig, !keyframe.movable});
  }
  for (const WindowMotion& motion : window.motions) bundle.problem.motions.push_back(bundle_motion(window, motion));
  for (std::size_t p = 0; p < window.points.size(); ++p) {
    const WindowPoint& point = window.points[p];
    const bool is_fixed = byre::is_fixed(window, point);
    bundle.problem.points.push_back({point.point.position_in_world, is_fixed});
    if (point.removed) continue;
    for (const WindowObservation& seen : point.observations) {
      if (is_fixed && !window.keyframe(seen.keyframe).movable) continue;
      BundleObservation observation = weighted_observation(window, point, seen, is_fixed, offline_weight);
      observation.pose = seen.keyframe;
      observation.point = static_cast<int>(p);
      bundle.problem.observations.push_back(observation);
      bundle.features.push_back(seen.feature);
    }
  }
  return bundle;
}

// Factor on the gate of squared errors for fixed points. Movable points adapt to common errors of their views, fixed
// points do not.
double tolerance_of(const BundleObservation& observation) {
  const double systematic_sigma = PoseRefinementOptions{}.systematic_sigma;
  const double sigma = std::max(observation.pixel_sigma, observation.disparity_sigma);
  return 1.0 + std::pow(systematic_sigma / sigma, 2);
}

bool is_outlier(const BundleObservation& observation, bool of_fixed_point, double squared_error) {
  const double gate = observation.is_stereo() ? kMaxSquaredErrorStereo : kMaxSquaredErrorMono;
  return !(squared_error <= gate * (of_fixed_point ? tolerance_of(observation) : 1.0));
}

void write_back(MapWindow& window, const WindowBundle& bundle, const BundleResult& result) {
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (window.keyframes[i].movable) window.keyframes[i].keyframe.camera_from_world = result.camera_from_world[i];
  }
  for (std::size_t i = 0; i < window.points.size(); ++i) {
    if (!bundle.problem.points[i].fixed) window.points[i].point.position_in_world = result.points_in_world[i];
  }
}

// Repairs an online point that lost a view: a removed reference is replaced by the first online view; a point without
// one is removed. Points that are also seen outside the window are left to the map.
void repair(MapWindow& window, int index) {
  WindowPoint& point = window.point(index);
  if (is_offline(point) || point.observations_elsewhere > 0) return;
  const auto is_reference = [&](const WindowObservation& seen) {
    return window.keyframe(seen.keyframe).id == point.point.reference.keyframe;
  };
  if (std::ranges::any_of(point.observations, is_reference)) return;
  const auto first = first_online_observation(window, point);
  if (!first) return remove_point(window, index);
  point.point.reference = {window.keyframe(first->keyframe).id, first->feature};
}

void remove_outliers(MapWindow& window, const WindowBundle& bundle, const BundleResult& result) {
  for (std::size_t i = 0; i < bundle.features.size(); ++i) {
    const BundleObservation& observation = bundle.problem.observations[i];
    const bool of_fixed_point = bundle.problem.points[static_cast<std::size_t>(observation.point)].fixed;
    if (!is_outlier(observation, of_fixed_point, result.squared_errors[i])) continue;
    const WindowObservation seen = bundle.seen(i);
    if (window.keyframe(seen.keyframe).point_of_feature[static_cast<std::size_t>(seen.feature)] != observation.point) {
      continue;  // removed with its point
    }
    remove_observation(window, seen);
    repair(window, observation.point);
  }
}

// Covariance of the anchors as a whole, which the window shares: the median one. Individual errors of anchors average
// out, so the largest is too large; common errors do not, so the smallest is too small.
Matrix6 anchor_covariance(const MapWindow& window) {
  const Pose& centre_from_world = window.keyframes.front().keyframe.camera_from_world;
  std::vector<Matrix6> covariances;
  for (const WindowKeyframe& anchor : window.keyframes) {
    if (anchor.movable) continue;
    covariances.push_back(
        move_covariance(anchor.keyframe.covariance, centre_from_world * inverse(anchor.keyframe.camera_from_world)));
  }
  if (covariances.empty()) return Matrix6::Zero();
  const auto middle = covariances.begin() + static_cast<std::ptrdiff_t>(covariances.size() / 2);
  std::ranges::nth_element(covariances, middle, {}, [](const Matrix6& covariance) { return covariance.trace(); });
  return *middle;
}

bool has_anchor(const BundleProblem& problem) {
  return std::ranges::any_of(problem.poses, &BundlePose::fixed) ||
         std::ranges::any_of(problem.points, &BundlePoint::fixed);
}

void adjust_in_two_rounds(MapWindow& window, const MappingOptions& options, const std::function<bool()>& should_stop) {
  BundleOptions bundle_options;
  bundle_options.should_stop = should_stop;
  bundle_options.systematic_sigma = options.systematic_sigma;
  for (const bool last_round : {false, true}) {
    bundle_options.max_iterations = last_round ? options.second_bundle_iterations : options.first_bundle_iterations;
    const WindowBundle bundle = make_bundle(window, options.offline_weight);
    const bool is_relative_to_anchors = window.keyframes.front().movable && has_anchor(bundle.problem);
    bundle_options.covariance_of_pose = last_round && is_relative_to_anchors ? 0 : -1;
    const BundleResult result = bundle_adjust(bundle.problem, bundle_options);
    if (!result.usable) return;
    write_back(window, bundle, result);
    if (result.pose_covariance) {
      window.keyframes.front().keyframe.covariance = *result.pose_covariance + anchor_covariance(window);
    }
    remove_outliers(window, bundle, result);
  }
}

}  // namespace

BundleObservation bundle_observation(const WindowKeyframe& keyframe, int feature) {
  const Sighting& sighting = keyframe.keyframe.sightings[static_cast<std::size_t>(feature)];
  const Keypoint& keypoint = keyframe.keyframe.frame.features->keypoint(feature);
  BundleObservation observation;
  observation.measured << sighting.pixel.cast<double>(), keypoint.disparity;
  observation.pixel_sigma = sighting.pixel_sigma;
  observation.disparity_sigma = keypoint.has_disparity() ? keypoint.disparity_sigma : -1.0;
  return observation;
}

void adjust_bundle(MapWindow& window, const MappingOptions& options, const std::function<bool()>& should_stop) {
  const bool any_movable = std::ranges::any_of(window.keyframes, &WindowKeyframe::movable);
  if (any_movable) adjust_in_two_rounds(window, options, should_stop);
}

void refresh_covariances(MapWindow& window, const MappingOptions& options) {
  constexpr std::size_t kFound = 32;
  const WindowBundle bundle = make_bundle(window, options.offline_weight);
  std::vector<bool> is_observed(window.keyframes.size(), false);
  for (const BundleObservation& seen : bundle.problem.observations)
    is_observed[static_cast<std::size_t>(seen.pose)] = true;
  std::vector<int> movable;
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    if (window.keyframes[i].movable && is_observed[i]) movable.push_back(static_cast<int>(i));
  }
  BundleOptions bundle_options;
  bundle_options.max_iterations = 0;
  const std::size_t found = std::min(kFound, movable.size());
  for (std::size_t i = 0; i < found; ++i) {
    bundle_options.covariances_of_poses.push_back(movable[(2 * i + 1) * movable.size() / (2 * found)]);
  }
  const BundleResult result = bundle_adjust(bundle.problem, bundle_options);
  if (result.pose_covariances.empty()) return;
  for (std::size_t i = 0; i < movable.size(); ++i) {
    const std::size_t nearest = i * found / movable.size();
    const auto other = static_cast<std::size_t>(bundle_options.covariances_of_poses[nearest]);
    Keyframe& keyframe = window.keyframe(movable[i]).keyframe;
    const Pose keyframe_from_other =
        keyframe.camera_from_world * inverse(window.keyframes[other].keyframe.camera_from_world);
    keyframe.covariance = move_covariance(result.pose_covariances[nearest], keyframe_from_other);
  }
}

void adjust_points(MapWindow& window, const MappingOptions& options) {
  assert(std::ranges::none_of(window.keyframes, &WindowKeyframe::movable));
  adjust_in_two_rounds(window, options, {});
}

}  // namespace byre
