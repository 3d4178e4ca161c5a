#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/pose_refinement.h"
#include "byre/simulation/simulated_mission.h"
#include "byre/slam/mission_scene.h"

#include <random>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

// A camera that moves a quarter round a room full of landmarks.
SimulatedMission mission_of(int frames) {
  SimulationOptions options;
  options.landmarks = 12000;
  options.max_features = 3000;
  return simulate_mission(simulated_rig(), circling_trajectory(frames, 10.0, 2.0, 0.25), options);
}

// Fills in what a pose's and a bundle's observation have in common.
template <typename AnyObservation>
AnyObservation measured(const Keypoint& keypoint) {
  const double scale = kScaleOfOctave[keypoint.octave];
  AnyObservation observation{};
  observation.measured = {keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity};
  observation.pixel_sigma = SimulationOptions{}.pixel_sigma * scale;
  if (keypoint.has_disparity()) observation.disparity_sigma = SimulationOptions{}.disparity_sigma * scale;
  return observation;
}

Vector6 small_motion(double metres, double radians) {
  Vector6 motion;
  motion << Eigen::Vector3d::Constant(metres), Eigen::Vector3d::Constant(radians);
  return motion;
}

std::vector<PoseObservation> observations_of_frame(const SimulatedMission& mission, int frame, std::size_t count) {
  const Features& features = *mission.frames[frame].features;
  std::vector<PoseObservation> observations;
  for (int i = 0; i < features.size() && observations.size() < count; ++i) {
    const int landmark = mission.landmark_of_feature[frame][i];
    observations.push_back(measured<PoseObservation>(features.keypoint(i)));
    observations.back().point_in_world = mission.landmarks_in_world[landmark];
    observations.back().point_covariance = 1e-4 * Eigen::Matrix3d::Identity();
  }
  return observations;
}

void refine_pose_on_500_observations(benchmark::State& state) {
  const SimulatedMission mission = mission_of(1);
  const std::vector<PoseObservation> observations = observations_of_frame(mission, 0, 500);
  const Pose predicted = exp_pose(small_motion(0.02, 0.01)) * true_camera_from_world(mission, 0);
  std::optional<PoseRefinement> refined;
  for (auto _ : state) refined = refine_pose(predicted, mission.rig, observations, {});
  state.counters["observations"] = static_cast<double>(observations.size());
  state.counters["inliers"] = refined ? refined->inlier_count : 0;
}
BENCHMARK(refine_pose_on_500_observations)->Unit(benchmark::kMicrosecond);

struct BundleSize {
  int movable_poses;
  int fixed_poses;
  std::size_t points;
  std::size_t views_per_point;
};

// Per landmark, the poses that see it, and where.
std::vector<std::vector<BundleObservation>> views_of_landmarks(const SimulatedMission& mission) {
  std::vector<std::vector<BundleObservation>> views(mission.landmarks_in_world.size());
  for (std::size_t frame = 0; frame < mission.frames.size(); ++frame) {
    const std::vector<Keypoint>& keypoints = mission.frames[frame].features->keypoints();
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      auto& views_of_this = views[mission.landmark_of_feature[frame][i]];
      views_of_this.push_back(measured<BundleObservation>(keypoints[i]));
      views_of_this.back().pose = static_cast<int>(frame);
    }
  }
  return views;
}

// Points and movable poses are displaced; each point is seen from poses next to each other.
BundleProblem bundle_of(const BundleSize& size) {
  const SimulatedMission mission = mission_of(size.fixed_poses + size.movable_poses);
  std::mt19937 generator(1);
  BundleProblem problem;
  problem.rigs = {mission.rig};
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const bool fixed = static_cast<int>(i) < size.fixed_poses;
    const Pose displacement = fixed ? Pose{} : exp_pose(small_motion(0.01, 0.005));
    problem.poses.push_back({displacement * true_camera_from_world(mission, i), 0, fixed});
  }
  const auto views = views_of_landmarks(mission);
  for (std::size_t landmark = 0; landmark < views.size() && problem.points.size() < size.points; ++landmark) {
    if (views[landmark].size() < size.views_per_point) continue;
    const std::size_t first = generator() % (views[landmark].size() - size.views_per_point + 1);
    for (std::size_t i = first; i < first + size.views_per_point; ++i) {
      problem.observations.push_back(views[landmark][i]);
      problem.observations.back().point = static_cast<int>(problem.points.size());
    }
    problem.points.push_back({mission.landmarks_in_world[landmark] + Eigen::Vector3d::Constant(0.02)});
  }
  return problem;
}

// As large as a local bundle in a well-known room; with the covariance of the newest pose, as mapping asks for it.
void adjust_local_bundle(benchmark::State& state) {
  const BundleProblem problem =
      bundle_of({.movable_poses = 15, .fixed_poses = 20, .points = 2500, .views_per_point = 4});
  BundleOptions options;
  options.covariance_of_pose = static_cast<int>(problem.poses.size()) - 1;
  BundleResult result;
  for (auto _ : state) result = bundle_adjust(problem, options);
  state.counters["points"] = static_cast<double>(problem.points.size());
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["solver_iterations"] = result.iterations;
}
BENCHMARK(adjust_local_bundle)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
