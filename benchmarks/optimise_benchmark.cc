#include "hot_loop.h"

#include "byre/optimise/bundle_adjustment.h"
#include "byre/optimise/pose_graph_scene.h"
#include "byre/optimise/pose_refinement.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/slam/tracking/mission_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>
#include <string>

#include <benchmark/benchmark.h>

namespace byre {
namespace {

// A camera that moves through a quarter circle in a room with many landmarks.
SimulatedMission mission_of(int frames) {
  SimulationOptions options;
  options.landmarks = 12000;
  options.max_features = 3000;
  return simulate_mission(simulated_rig(), circling_trajectory(frames, 10.0, 2.0, 0.25), options);
}

// Sets the fields common to observations of poses and of bundles.
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
  measure_hot_loop(state, [&] { refined = refine_pose(predicted, mission.rig, observations, {}); });
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

std::vector<std::vector<BundleObservation>> views_of_landmarks(const SimulatedMission& mission) {
  std::vector<std::vector<BundleObservation>> views(mission.landmarks_in_world.size());
  for (std::size_t frame = 0; frame < mission.frames.size(); ++frame) {
    const std::span<const Keypoint> keypoints = mission.frames[frame].features->keypoints();
    for (std::size_t i = 0; i < keypoints.size(); ++i) {
      auto& views_of_this = views[mission.landmark_of_feature[frame][i]];
      views_of_this.push_back(measured<BundleObservation>(keypoints[i]));
      views_of_this.back().pose = static_cast<int>(frame);
    }
  }
  return views;
}

// Points and movable poses are perturbed; each point is observed from consecutive poses.
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

// The size of a local bundle in a well-mapped room; with the covariance of the newest pose, as in mapping.
void adjust_local_bundle(benchmark::State& state) {
  const BundleProblem problem =
      bundle_of({.movable_poses = 15, .fixed_poses = 20, .points = 2500, .views_per_point = 4});
  BundleOptions options;
  options.covariance_of_pose = static_cast<int>(problem.poses.size()) - 1;
  BundleResult result;
  measure_hot_loop(state, [&] { result = bundle_adjust(problem, options); });
  state.counters["points"] = static_cast<double>(problem.points.size());
  state.counters["observations"] = static_cast<double>(problem.observations.size());
  state.counters["solver_iterations"] = result.iterations;
}
BENCHMARK(adjust_local_bundle)->Unit(benchmark::kMillisecond);

// Peak memory of the program; that of one benchmark only if it runs alone.
double peak_megabytes() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024.0;
  }
  return 0.0;
}

// A forward-looking camera that drives twice around a ring of corridors, one pose every third of a metre, and observes
// in the second round the points of the first.
class Building {
 public:
  Building(int poses, int points) : poses_(poses) {
    problem_.rigs = {simulated_rig()};
    for (int i = 0; i < poses; ++i) problem_.poses.push_back({true_camera_from_world(i), 0, i == 0});
    for (int i = 0; i < points; ++i) add_point();
    std::ranges::stable_sort(problem_.observations, {}, &BundleObservation::pose);  // the order of keyframes
    for (BundlePose& pose : problem_.poses) {
      if (!pose.fixed) pose.camera_from_world = exp_pose(random_motion(0.03, 0.01)) * pose.camera_from_world;
    }
    for (BundlePoint& point : problem_.points) point.position_in_world += random_motion(0.05, 0.0).head<3>();
  }

  const BundleProblem& problem() const { return problem_; }

  // Root mean square error, metres.
  double position_error(const std::vector<Pose>& camera_from_world) const {
    double sum = 0.0;
    for (int i = 0; i < poses_; ++i) {
      sum += (inverse(camera_from_world[i]).translation - inverse(true_camera_from_world(i)).translation).squaredNorm();
    }
    return std::sqrt(sum / poses_);
  }

 private:
  static constexpr double kPixelSigma = 0.8;
  static constexpr double kDisparitySigma = 0.4;
  static constexpr double kOutliers = 0.03;

  Pose true_camera_from_world(int pose) const {
    const double radius = poses_ / 3.0 / (2.0 * std::numbers::pi);
    const double angle = 4.0 * std::numbers::pi * pose / poses_;
    const Pose world_from_turned{rotation_exp({0.0, -angle, 0.0}), Eigen::Vector3d::Zero()};
    return inverse(world_from_turned * Pose{Eigen::Quaterniond::Identity(), {radius, 0.0, 0.0}});
  }

  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(generator_); }
  double normal(double sigma) { return std::normal_distribution<double>(0.0, sigma)(generator_); }

  Vector6 random_motion(double metres, double radians) {
    Vector6 motion;
    for (int i = 0; i < 6; ++i) motion[i] = normal(1.0) * (i < 3 ? metres : radians);
    return motion;
  }

  bool sees(int pose, const Eigen::Vector3d& point_in_world) const {
    const Rig& rig = problem_.rigs[0];
    const Eigen::Vector3d point_in_camera = problem_.poses[pose].camera_from_world * point_in_world;
    return point_in_camera.z() > 0.5 && point_in_camera.z() < 10.0 &&
           rig.contains(rig.project(point_in_camera).head<2>());
  }

  // Poses of both rounds that see a point, those near the given one first.
  std::vector<int> poses_that_see(const Eigen::Vector3d& point_in_world, int near) const {
    constexpr int kReach = 15;
    std::vector<int> poses;
    for (int away = 0; away <= 2 * kReach; ++away) {
      const int step = away % 2 == 0 ? away / 2 : -(away + 1) / 2;
      for (const int round : {0, poses_ / 2}) {
        const int pose = (near + step + round + poses_) % poses_;
        if (sees(pose, point_in_world)) poses.push_back(pose);
      }
    }
    return poses;
  }

  // Adds a point with four to eight observations.
  void add_point() {
    const Rig& rig = problem_.rigs[0];
    for (;;) {
      const int near = static_cast<int>(uniform(0.0, poses_));
      const Eigen::Vector3d ray = rig.ray({uniform(0.0, rig.width), uniform(0.0, rig.height)});
      const Eigen::Vector3d point_in_world =
          inverse(problem_.poses[near].camera_from_world) * (uniform(1.5, 8.0) * ray);
      std::vector<int> poses = poses_that_see(point_in_world, near);
      if (poses.size() < 4) continue;
      poses.resize(std::min(poses.size(), static_cast<std::size_t>(uniform(4.0, 9.0))));
      problem_.points.push_back({point_in_world, false});
      for (const int pose : poses) add_observation(pose);
      return;
    }
  }

  // Adds the observation of the newest point by a pose.
  void add_observation(int pose) {
    BundleObservation observation{.pose = pose, .point = static_cast<int>(problem_.points.size()) - 1, .measured = {}};
    observation.measured =
        problem_.rigs[0].project(problem_.poses[pose].camera_from_world * problem_.points.back().position_in_world) +
        Eigen::Vector3d{normal(kPixelSigma), normal(kPixelSigma), normal(kDisparitySigma)};
    if (uniform(0.0, 1.0) < kOutliers) observation.measured += 30.0 * random_motion(1.0, 0.0).head<3>();
    observation.pixel_sigma = kPixelSigma;
    observation.disparity_sigma = kDisparitySigma;
    problem_.observations.push_back(observation);
  }

  int poses_;
  std::mt19937 generator_{1};
  BundleProblem problem_;
};

// Global bundle adjustment, wall and CPU time. To measure the memory of one size, run it alone.
void adjust_building(benchmark::State& state) {
  const Building building(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)));
  const double before = peak_megabytes();
  BundleOptions options;
  options.max_iterations = 15;
  BundleResult result;
  for (auto _ : state) result = bundle_adjust(building.problem(), options);
  state.counters["observations"] = static_cast<double>(building.problem().observations.size());
  state.counters["solver_iterations"] = result.iterations;
  state.counters["position_error_mm"] = 1000.0 * building.position_error(result.camera_from_world);
  state.counters["before_MB"] = before;
  state.counters["peak_MB"] = peak_megabytes();
}
BENCHMARK(adjust_building)
    ->ArgNames({"poses", "points"})
    ->Args({300, 40000})
    ->Args({1000, 100000})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond)
    ->MeasureProcessCPUTime();

// Two rounds of odometry, connected by loop edges.
void optimise_graph(benchmark::State& state, bool scale_is_free) {
  const PoseGraph measured = measured_graph(
      1, {.nodes = 1000, .radius = 20.0, .links = 2, .loops = 6, .position_noise = 0.02, .rotation_noise = 0.002});
  const PoseGraph drifted = with_odometry(measured);
  PoseGraphOptions options;
  options.scale_is_free = scale_is_free;
  PoseGraphResult result;
  for (auto _ : state) result = optimise_pose_graph(drifted, options);
  state.counters["edges"] = static_cast<double>(drifted.edges.size());
  state.counters["solver_iterations"] = result.iterations;
  state.counters["drift_mm"] = 1000.0 * position_error(poses_of(drifted), measured);
  state.counters["error_mm"] = 1000.0 * position_error(result.camera_from_world, measured);
}
BENCHMARK_CAPTURE(optimise_graph, rigid, false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(optimise_graph, with_scales, true)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace byre
