#pragma once

#include "byre/map/plan/floor_plan.h"

#include <random>
#include <string>
#include <vector>

namespace byre {

inline constexpr double kPickNoise = 0.03;  // metres, of manual picks on a plan

// A barn of 40 x 12 m on a plan, the path of a robot along its alley and back, and signs visible in both. The map frame
// is rotated about all axes relative to the plan.
class FloorPlanScene {
 public:
  explicit FloorPlanScene(std::uint64_t seed = 1, double metres_per_unit = 1.0) : random_(seed) {
    plan_from_map.scale = metres_per_unit;
    plan_from_map.target_from_source.rotation =
        Eigen::AngleAxisd(2.1, Eigen::Vector3d::UnitZ()) * rotation_exp({0.3, -0.2, 0.1});
    plan_from_map.target_from_source.translation << 7.0, 2.0, 0.8;
  }

  Similarity plan_from_map;

  Eigen::Vector3d in_map(const Eigen::Vector3d& point_in_plan) const {
    const Pose map_from_plan = inverse(plan_from_map.target_from_source);
    return (map_from_plan * point_in_plan) / plan_from_map.scale;
  }

  // Along one side of the alley and back along the other, with noise. Width zero: on one line.
  std::vector<Eigen::Vector3d> path_in_map(double width = 2.0, double noise = 0.0) {
    std::vector<Eigen::Vector3d> path;
    for (int i = 0; i < 80; ++i) {
      const double along = i < 40 ? i : 79 - i;
      const Eigen::Vector3d position(1.0 + along, i < 40 ? -width / 2.0 : width / 2.0, 0.0);
      path.push_back(in_map(position + noise * normal()));
    }
    return path;
  }

  // Up direction of a level camera, or of one rolled across or pitched along the alley.
  Eigen::Vector3d up_of_rig_in_map(double roll = 0.0, double pitch = 0.0) const {
    const Eigen::Vector3d up_in_plan = rotation_exp({roll, pitch, 0.0}) * Eigen::Vector3d::UnitZ();
    return plan_from_map.target_from_source.rotation.conjugate() * up_in_plan;
  }

  DrivingPlane plane() { return fit_driving_plane(path_in_map(), up_of_rig_in_map()); }

  // Keyframes at intervals of one second of a body on the path with z up, whose camera looks along the body's x axis.
  MapGraph driven_map(const std::vector<Eigen::Vector3d>& path_in_map) const {
    Rig rig{320, 240, 188.0, 158.0, 119.0, 0.11, {}};
    Eigen::Matrix3d body_from_camera;
    body_from_camera << 0, 0, 1, -1, 0, 0, 0, -1, 0;
    rig.body_from_camera = {Eigen::Quaterniond(body_from_camera), {0.3, 0.1, 0.9}};
    MapGraph map(Origin::offline);
    map.add_rig(rig);
    for (const Eigen::Vector3d& position : path_in_map) {
      Keyframe keyframe;
      keyframe.frame.time = std::chrono::seconds(map.keyframe_count());
      const Pose map_from_body{plan_from_map.target_from_source.rotation.conjugate(), position};
      keyframe.camera_from_world = inverse(map_from_body * rig.body_from_camera);
      map.add_keyframe(keyframe);
    }
    return map;
  }

  // Signs all over the barn, one to three metres high, with normally distributed errors in x and y.
  std::vector<PlanCorrespondence> correspondences(int count, double noise = 0.0) {
    std::vector<PlanCorrespondence> all;
    for (int i = 0; i < count; ++i) {
      const double along = count > 1 ? 2.0 + 36.0 * i / (count - 1) : 2.0;
      const Eigen::Vector3d sign(along, i % 2 == 0 ? -5.0 : 5.0, 1.0 + i % 3);
      all.push_back({"sign " + std::to_string(i), in_map(sign), (sign + noise * normal()).head<2>()});
    }
    return all;
  }

  // Root-mean-square position error along the body's path, metres.
  double path_error(const Similarity& estimate) {
    double squares = 0.0;
    const std::vector<Eigen::Vector3d> path = path_in_map();
    for (const Eigen::Vector3d& position : path)
      squares += (estimate * position - plan_from_map * position).squaredNorm();
    return std::sqrt(squares / static_cast<double>(path.size()));
  }

  // Largest position error of the corners of the barn's floor, metres.
  double worst_error(const Similarity& estimate) const {
    double worst = 0.0;
    for (const double x : {0.0, 40.0}) {
      for (const double y : {-6.0, 6.0}) {
        const Eigen::Vector3d corner(x, y, 0.0);
        worst = std::max(worst, (estimate * in_map(corner) - corner).norm());
      }
    }
    return worst;
  }

 private:
  Eigen::Vector3d normal() {
    std::normal_distribution<double> distribution;
    Eigen::Vector3d values;
    for (double& value : values) value = distribution(random_);
    return values;
  }

  std::mt19937_64 random_;
};

}  // namespace byre
