#include "byre/simulation/simulated_trajectory_scene.h"

#include "byre/geometry/geometry_matchers.h"

#include <functional>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::SizeIs;

Eigen::Vector3d looking_direction(const Pose& world_from_camera) {
  return world_from_camera.rotation * Eigen::Vector3d::UnitZ();
}

struct NamedTrajectory {
  const char* name;
  std::function<Trajectory(const Pose& body_from_camera)> make;
};

class EveryTrajectory : public ::testing::TestWithParam<NamedTrajectory> {};

TEST_P(EveryTrajectory, IsSampledAtTheFrameRate) {
  const Trajectory trajectory = GetParam().make({});
  ASSERT_THAT(trajectory, SizeIs(201));
  for (std::size_t i = 0; i < trajectory.size(); ++i) {
    EXPECT_EQ(trajectory[i].time, std::chrono::milliseconds(50) * static_cast<int>(i));
  }
}

TEST_P(EveryTrajectory, EndsAtItsStartAfterWholeLaps) {
  const Trajectory trajectory = GetParam().make({});
  EXPECT_THAT(trajectory.back().world_from_body, PoseNear(trajectory.front().world_from_body, 1e-9, 1e-6));
}

TEST_P(EveryTrajectory, MovesSmoothly) {
  const Trajectory trajectory = GetParam().make({});
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    EXPECT_THAT(trajectory[i].world_from_body, PoseNear(trajectory[i - 1].world_from_body, 0.1, 0.15));
  }
}

TEST_P(EveryTrajectory, KeepsTheCameraUpright) {
  for (const StampedPose& sample : GetParam().make({})) {
    const Eigen::Vector3d down_in_world = sample.world_from_body.rotation * Eigen::Vector3d::UnitY();
    EXPECT_LT(down_in_world.z(), -0.95);
  }
}

TEST_P(EveryTrajectory, PlacesTheCameraIndependentOfTheBody) {
  const Pose body_from_camera = robot_from_camera();
  const Trajectory cameras = GetParam().make({});
  const Trajectory robots = GetParam().make(body_from_camera);
  ASSERT_EQ(cameras.size(), robots.size());
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    EXPECT_THAT(robots[i].world_from_body * body_from_camera, PoseNear(cameras[i].world_from_body, 1e-9, 1e-6));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Of, EveryTrajectory,
    ::testing::Values(
        NamedTrajectory{"Circling", [](const Pose& body) { return circling_trajectory(201, 20.0, 2.0, 1.0, body); }},
        NamedTrajectory{"Turning", [](const Pose& body) { return turning_in_place_trajectory(201, 20.0, 1.0, body); }},
        NamedTrajectory{"FigureEight",
                        [](const Pose& body) { return figure_eight_trajectory(201, 20.0, 4.0, 1.0, body); }}),
    [](const auto& tested) { return tested.param.name; });

TEST(CirclingTrajectory, LooksAlongItsMotion) {
  const Trajectory trajectory = circling_trajectory(1001, 20.0, 2.0, 1.0);
  for (std::size_t i = 1; i < trajectory.size(); ++i) {
    const Pose& pose = trajectory[i].world_from_body;
    const Eigen::Vector3d motion = pose.translation - trajectory[i - 1].world_from_body.translation;
    EXPECT_GT(looking_direction(pose).dot(motion.normalized()), 0.9999);
    EXPECT_NEAR(pose.translation.norm(), 2.0, 1e-9);
  }
}

TEST(TurningInPlace, StaysInPlaceAndTurnsLeft) {
  const Trajectory trajectory = turning_in_place_trajectory(5, 1.0, 1.0);
  EXPECT_THAT(looking_direction(trajectory[0].world_from_body), PointNear(Eigen::Vector3d::UnitX(), 1e-9));
  EXPECT_THAT(looking_direction(trajectory[1].world_from_body), PointNear(Eigen::Vector3d::UnitY(), 1e-9));
  for (const StampedPose& sample : trajectory) EXPECT_EQ(sample.world_from_body.translation.norm(), 0.0);
}

TEST(RobotFromCamera, LooksAlongTheBodyXAxisWithZUp) {
  const Eigen::Quaterniond body_from_camera = robot_from_camera().rotation;
  EXPECT_THAT(body_from_camera * Eigen::Vector3d::UnitZ(), PointNear(Eigen::Vector3d::UnitX(), 1e-12));
  EXPECT_THAT(body_from_camera * Eigen::Vector3d::UnitY(), PointNear(-Eigen::Vector3d::UnitZ(), 1e-12));
}

}  // namespace
}  // namespace byre
