#include "byre/ros2/node/slam_runner.h"

#include "byre/geometry/geometry_matchers.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

// Forward (z of the camera) is x of the base, right is -y, down is -z.
const Pose kBaseFromLeft{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.3, 0.0, 0.5}};

NodeConfig wheeled() {
  NodeConfig config;
  config.task = NodeTask::map;
  config.wheels = "/odom";
  config.extrinsics = ExtrinsicsSource::tf;
  return config;
}

TEST(ExtrinsicsOfRunner, StartWithTheTransformIfTheWheelsMeasureItsBase) {
  SlamRunner runner(wheeled());
  EXPECT_THAT(runner.take_extrinsics(kBaseFromLeft, "base_link"),
              AllOf(HasSubstr("the wheels on /odom start with the transform base_link"), HasSubstr("/tf_static")));
  ASSERT_TRUE(runner.options().extrinsics);
  ASSERT_TRUE(runner.options().extrinsics->camera);
  EXPECT_THAT(runner.options().extrinsics->camera->base_from_sensor, PoseNear(kBaseFromLeft, 1e-12, 1e-9));
}

TEST(ExtrinsicsOfRunner, LeaveOutATransformOfAnotherBase) {
  SlamRunner runner(wheeled());
  EXPECT_THAT(runner.take_extrinsics(kBaseFromLeft, "rear_axle"),
              HasSubstr("measures the motion of 'rear_axle', not of base_link"));
  EXPECT_THAT(runner.take_extrinsics(kBaseFromLeft, std::nullopt), HasSubstr("no message on /odom"));
  const Pose without_optical_axes{Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.5}};
  EXPECT_THAT(runner.take_extrinsics(without_optical_axes, "base_link"), HasSubstr("looks up or down"));
  EXPECT_FALSE(runner.options().extrinsics);
}

TEST(ExtrinsicsOfRunner, NeedWheelsAndTransforms) {
  NodeConfig config = wheeled();
  config.wheels.clear();
  SlamRunner without_wheels(config);
  EXPECT_EQ(without_wheels.take_extrinsics(kBaseFromLeft, std::nullopt), "");
  EXPECT_FALSE(without_wheels.options().extrinsics);
  config = wheeled();
  config.extrinsics = ExtrinsicsSource::camera;
  SlamRunner of_camera(config);
  EXPECT_EQ(of_camera.take_extrinsics({}, "base_link"), "");
  EXPECT_FALSE(of_camera.options().extrinsics);
}

TEST(ExtrinsicsOfRunner, AreThoseOfTheFileIfBothAreGiven) {
  const fs::path file = fs::path(testing::TempDir()) / ("byre_mounts." + std::to_string(getpid()) + ".yaml");
  std::ofstream(file) << "base_from_camera:\n  translation_m: [0.4, 0.1, 0.9]\n  rpy_deg: [0, 0, 0]\n"
                         "camera_axes: body\nwheels:\n  scale: 1.02\n";
  NodeConfig config = wheeled();
  config.extrinsics_file = file;
  SlamRunner runner(config);
  EXPECT_THAT(runner.take_extrinsics(kBaseFromLeft, "base_link"),
              AllOf(HasSubstr(file.string()), HasSubstr("; not the transform base_link")));
  ASSERT_TRUE(runner.options().extrinsics);
  EXPECT_EQ(runner.options().extrinsics->wheel_scale, 1.02);
  const Pose expected{kBaseFromLeft.rotation, {0.4, 0.1, 0.9}};
  EXPECT_THAT(runner.options().extrinsics->camera->base_from_sensor, PoseNear(expected, 1e-9, 1e-6));
  config.wheels.clear();
  EXPECT_THAT(SlamRunner(config).take_extrinsics(kBaseFromLeft, std::nullopt), Not(HasSubstr("transform")));
  fs::remove(file);
}

}  // namespace
}  // namespace byre
