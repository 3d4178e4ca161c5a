#include "byre/slam/system/slam_impl.h"

#include "byre/slam/places/place_scene.h"
#include "byre/trajectory_error.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

Calibration one_camera() {
  const Rig rig = simulated_rig();
  Calibration calibration;
  calibration.left.width = rig.width;
  calibration.left.height = rig.height;
  calibration.left.fx = calibration.left.fy = rig.focal;
  calibration.left.cx = rig.cx;
  calibration.left.cy = rig.cy;
  return calibration;
}

// Robot with one camera that drives a figure of eight.
SimulatedMission figure_eight(const Rig& rig) {
  Trajectory path = figure_eight_trajectory(200, 10.0, 4.0, 1.0, robot_from_camera());
  for (StampedPose& pose : path) pose.world_from_body = pose.world_from_body * robot_from_camera();
  SimulationOptions visit;
  visit.landmarks = 8000;
  return simulate_mission(rig, path, visit);
}

struct MonocularMap {
  bool is_metric = false;
  double error = 0.0;  // root-mean-square position error, metres
};

// Map of a figure of eight by one camera. measured: path lengths and turns of the wheels as a share of the true ones;
// empty without wheels.
MonocularMap monocular_map(std::optional<double> measured) {
  MethodOptions options;
  options.pace = Pace::same_thread;
  SlamImpl slam(one_camera(), options, {.vocabulary = simulated_vocabulary()});
  const SimulatedMission mission = figure_eight(slam.rig());
  const Pose camera_from_robot = inverse(robot_from_camera());
  Pose wheels, last;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const Pose now = mission.truth[i].world_from_body * camera_from_robot;
    if (measured) {
      const Pose motion = i > 0 ? inverse(last) * now : Pose{};
      wheels = wheels * Pose{rotation_exp(*measured * rotation_log(motion.rotation)), *measured * motion.translation};
      slam.add_wheel_odometry({mission.truth[i].time, wheels});
    }
    last = now;
    slam.process(mission.frames[i]);
  }
  EXPECT_FALSE(slam.is_metric());
  slam.finish({[] { return false; }, {}});
  const auto pairs = associate(slam.trajectory(), mission.truth, {});
  EXPECT_GT(pairs.size(), 150u);
  const auto error = absolute_trajectory_error(pairs, Scale::fixed);
  return {slam.is_metric(), error ? error->translation.rmse : -1.0};
}

TEST(SlamImpl, ScalesAMonocularMapByWheels) {
  const MonocularMap with = monocular_map(1.0), without = monocular_map({});
  EXPECT_TRUE(with.is_metric);
  EXPECT_LT(with.error, 0.06);
  EXPECT_FALSE(without.is_metric);
  EXPECT_GT(without.error, 0.06);
}

TEST(SlamImpl, RefusesTheScaleOfAWrongWheelRadius) {
  EXPECT_FALSE(monocular_map(1.08).is_metric);
  EXPECT_FALSE(monocular_map(0.92).is_metric);
}

}  // namespace
}  // namespace byre
