#include "byre/io/recording/motion_files.h"

#include "byre/input_error.h"
#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::HasSubstr;

constexpr const char* kWheels = "1.0 0 0 0 0 0 0 1\n1.5 0.25 0 0 0 0 0 1\n";

using MotionFiles = TestFolder;

TEST_F(MotionFiles, AreEmptyWithoutSamples) {
  const MotionSamples samples = read_motion(folder_, {}).samples;
  EXPECT_TRUE(samples.wheels.empty());
  EXPECT_TRUE(samples.rates.empty());
}

TEST_F(MotionFiles, ReadWheelsUnlessOmitted) {
  write("wheel.txt", kWheels);
  const MotionSamples samples = read_motion(folder_, {}).samples;
  ASSERT_EQ(samples.wheels.size(), 2u);
  EXPECT_EQ(samples.wheels.back().time, std::chrono::milliseconds(1500));
  EXPECT_EQ(samples.wheels.back().world_from_body.translation.x(), 0.25);
  EXPECT_TRUE(read_motion(folder_, {.use_wheels = false}).samples.wheels.empty());
}

TEST_F(MotionFiles, ReadFromAnotherFolder) {
  write("other/odometry.txt", kWheels);
  EXPECT_EQ(read_motion(folder_, {.wheels = folder_ / "other/odometry.txt"}).samples.wheels.size(), 2u);
  EXPECT_THROW(read_motion(folder_, {.wheels = folder_ / "none.txt"}), InputError);
}

TEST_F(MotionFiles, ReadTheGyroscopeOnRequest) {
  write("mav0/cam0/data.csv", "");
  write("mav0/imu0/data.csv",
        "#timestamp [ns],w_x,w_y,w_z,a_x,a_y,a_z\n100,0.1,0.2,0.3,0,0,9.8\n200,0.4,0.5,0.6,0,0,9.8\n");
  EXPECT_TRUE(read_motion(folder_, {}).samples.rates.empty());
  const MotionSamples samples = read_motion(folder_, {.use_gyroscope = true}).samples;
  ASSERT_EQ(samples.rates.size(), 2u);
  EXPECT_EQ(samples.rates.back().time, Timestamp(200));
  EXPECT_EQ(samples.rates.back().rate, Eigen::Vector3d(0.4, 0.5, 0.6));
}

TEST_F(MotionFiles, ReadTheAccelerometerWithTheGyroscope) {
  write("mav0/cam0/data.csv", "");
  write("mav0/imu0/data.csv", "100,0.1,0.2,0.3\n200,0.4,0.5,0.6,1.5,0,9.8\n300,0.4,0.5,0.6,0,0,0\n");
  const MotionSamples samples = read_motion(folder_, {.use_gyroscope = true}).samples;
  EXPECT_EQ(samples.rates.size(), 3u);
  ASSERT_EQ(samples.accelerations.size(), 1u) << "zeros mean a sensor without accelerometer";
  EXPECT_EQ(samples.accelerations[0].time, Timestamp(200));
  EXPECT_EQ(samples.accelerations[0].acceleration, Eigen::Vector3d(1.5, 0.0, 9.8));
  EXPECT_FALSE(samples.left_from_gyroscope);
  write("mav0/imu0/sensor.yaml", "sensor_type: imu\nT_BS: {data: [0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]}\n");
  const Pose body_from_left{Eigen::Quaterniond(0.0, 1.0, 0.0, 0.0), {}};  // half a turn about x
  const auto turned = read_motion(folder_, {.use_gyroscope = true}, body_from_left).samples.left_from_gyroscope;
  ASSERT_TRUE(turned);
  EXPECT_TRUE((*turned * Eigen::Vector3d::UnitX()).isApprox(-Eigen::Vector3d::UnitY()));
  const OpenOptions other_body{.calibration = folder_ / "other.yaml", .use_gyroscope = true};
  EXPECT_FALSE(read_motion(folder_, other_body).samples.left_from_gyroscope);
}

TEST_F(MotionFiles, CountLateAndRepeatedLines) {
  write("wheel.txt", "1.0 0 0 0 0 0 0 1\n1.2 2 0 0 0 0 0 1\n1.1 1 0 0 0 0 0 1\n1.3 3 0 0 0 0 0 1\n1.3 4 0 0 0 0 0 1\n");
  const SensorMotion motion = read_motion(folder_, {});
  ASSERT_EQ(motion.samples.wheels.size(), 4u);
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(motion.samples.wheels[static_cast<std::size_t>(i)].world_from_body.translation.x(), i);
  EXPECT_THAT(motion.warnings, testing::ElementsAre(HasSubstr("1 lines were recorded after later ones"),
                                                    HasSubstr("1 lines have the time stamp of another one")));
}

TEST_F(MotionFiles, ReportInvalidGyroscopeFiles) {
  const auto failure = [&](const std::string& text) {
    write("mav0/cam0/data.csv", "");
    if (!text.empty()) write("mav0/imu0/data.csv", text);
    try {
      read_motion(folder_, {.use_gyroscope = true});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("read");
  };
  EXPECT_THAT(failure(""), HasSubstr("does not exist"));
  EXPECT_THAT(failure("100,0.1,0.2\n"), HasSubstr("fewer than four fields"));
  EXPECT_THAT(failure("100,0.1,0.2,left\n"), HasSubstr("\"left\" is not a number"));
  EXPECT_THAT(failure("100,0,0,0\n1 s,0,0,0\n"), HasSubstr("data.csv:2: \"1 s\" is not a time in nanoseconds"));
}

}  // namespace
}  // namespace byre
