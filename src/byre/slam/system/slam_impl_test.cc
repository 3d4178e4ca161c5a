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

TEST(SlamImpl, ScalesAMonocularMapByWheels) {
  for (const bool has_wheels : {true, false}) {
    MethodOptions options;
    options.pace = Pace::same_thread;
    SlamImpl slam(one_camera(), options, {.vocabulary = simulated_vocabulary()});
    const SimulatedMission mission = figure_eight(slam.rig());
    const Pose camera_from_robot = inverse(robot_from_camera());
    for (std::size_t i = 0; i < mission.frames.size(); ++i) {
      const StampedPose& truth = mission.truth[i];
      if (has_wheels) slam.add_wheel_odometry({truth.time, truth.world_from_body * camera_from_robot});
      slam.process(mission.frames[i]);
    }
    EXPECT_FALSE(slam.is_metric());
    slam.finish({[] { return false; }, {}});
    EXPECT_EQ(slam.is_metric(), has_wheels);
    const auto pairs = associate(slam.trajectory(), mission.truth, {});
    ASSERT_GT(pairs.size(), 150u);
    const auto error = absolute_trajectory_error(pairs, Scale::fixed);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->translation.rmse < 0.06, has_wheels) << error->translation.rmse << " m";
  }
}

}  // namespace
}  // namespace byre
