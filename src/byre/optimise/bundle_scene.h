#pragma once

// Synthetic bundles with ground truth, for the tests of this room.

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/optimise_scene.h"

#include <algorithm>

namespace byre {

struct BundleSceneOptions {
  int fixed_poses = 2;
  int moving_poses = 4;
  int points = 80;
  int fixed_points = 0;          // number of fixed points, the first ones
  double mono_fraction = 0.25;   // share of the observations without disparity
  double noise = 0.0;            // sigmas
  double start_position = 0.05;  // metres, of moving poses and points
  double start_rotation = 0.02;  // radians
};

// The truth, and the solver's input: moving poses and points displaced.
struct BundleScene {
  BundleProblem truth;
  BundleProblem problem;
};

inline constexpr double kPixelSigma = 0.8;
inline constexpr double kDisparitySigma = 0.4;

inline bool sees(const Rig& rig, const Pose& camera_from_world, const Eigen::Vector3d& point_in_world) {
  const Eigen::Vector3d point_in_camera = camera_from_world * point_in_world;
  return point_in_camera.z() > 0.5 && rig.contains(rig.project(point_in_camera).head<2>());
}

// A point in view of at least two poses.
inline Eigen::Vector3d shared_point(const BundleProblem& problem, Draw& draw) {
  for (;;) {
    const int first = static_cast<int>(draw.uniform(0.0, static_cast<double>(problem.poses.size())));
    const Eigen::Vector3d point_in_world =
        inverse(problem.poses[first].camera_from_world) * draw.point_in_view(problem.rigs[0]);
    const auto seen = std::ranges::count_if(problem.poses, [&](const BundlePose& pose) {
      return sees(problem.rigs[0], pose.camera_from_world, point_in_world);
    });
    if (seen >= 2) return point_in_world;
  }
}

inline BundleObservation observe(const BundleProblem& problem, int pose, int point, const BundleSceneOptions& options,
                                 Draw& draw) {
  BundleObservation observation{.pose = pose, .point = point, .measured = StereoPixel::Zero()};
  observation.measured =
      problem.rigs[0].project(problem.poses[pose].camera_from_world * problem.points[point].position_in_world);
  observation.measured +=
      options.noise * Eigen::Vector3d{draw.normal(kPixelSigma), draw.normal(kPixelSigma), draw.normal(kDisparitySigma)};
  observation.pixel_sigma = kPixelSigma;
  if (draw.uniform(0.0, 1.0) >= options.mono_fraction) observation.disparity_sigma = kDisparitySigma;
  return observation;
}

// Cameras in a row that view a cloud of points.
inline BundleProblem true_problem(const BundleSceneOptions& options, Draw& draw) {
  BundleProblem problem;
  problem.rigs.push_back(stereo_rig());
  for (int i = 0; i < options.fixed_poses + options.moving_poses; ++i) {
    Vector6 world_from_camera = draw.motion(0.05, 0.05);
    world_from_camera.x() += 0.15 * i;
    problem.poses.push_back({inverse(exp_pose(world_from_camera)), 0, i < options.fixed_poses});
  }
  for (int i = 0; i < options.points; ++i) {
    problem.points.push_back({shared_point(problem, draw), i < options.fixed_points});
  }
  for (int pose = 0; pose < static_cast<int>(problem.poses.size()); ++pose) {
    for (int point = 0; point < options.points; ++point) {
      if (!sees(problem.rigs[0], problem.poses[pose].camera_from_world, problem.points[point].position_in_world)) {
        continue;
      }
      problem.observations.push_back(observe(problem, pose, point, options, draw));
    }
  }
  return problem;
}

// Options for convergence to the last digit.
inline BundleOptions patient() {
  BundleOptions options;
  options.max_iterations = 50;
  return options;
}

inline BundleScene make_scene(unsigned seed, const BundleSceneOptions& options) {
  Draw draw(seed);
  BundleScene scene;
  scene.truth = true_problem(options, draw);
  scene.problem = scene.truth;
  for (BundlePose& pose : scene.problem.poses) {
    const Vector6 delta = draw.motion(options.start_position, options.start_rotation);
    if (!pose.fixed) pose.camera_from_world = exp_pose(delta) * pose.camera_from_world;
  }
  for (BundlePoint& point : scene.problem.points) {
    const Eigen::Vector3d delta = draw.normal3(options.start_position);
    if (!point.fixed) point.position_in_world += delta;
  }
  return scene;
}

}  // namespace byre
