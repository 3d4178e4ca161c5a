#include "byre/ros2/node/map_messages.h"

#include "byre/input_error.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;

class PlanFile : public testing::Test {
 protected:
  PlanFile() {
    fs::create_directories(folder_);
    std::ofstream(folder_ / "plan.pgm") << "P5\n3 2\n255\n" << std::string("\xff\x00\xff\x80\xff\x00", 6);
  }
  ~PlanFile() override { fs::remove_all(folder_); }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_plan_file." + std::to_string(getpid()));
};

TEST_F(PlanFile, IsConvertedToAGridFromTheLowestRow) {
  std::ofstream(folder_ / "plan.yaml") << "image: plan.pgm\nresolution: 0.5\norigin: [-1, 2, 0.3]\n";
  const ros::OccupancyGrid grid = grid_of(read_floor_plan(folder_ / "plan.yaml"));
  EXPECT_EQ(grid.info.width, 3u);
  EXPECT_EQ(grid.info.height, 2u);
  EXPECT_FLOAT_EQ(grid.info.resolution, 0.5f);
  EXPECT_NEAR(grid.info.origin.position.x, -1.0, 1e-9);
  EXPECT_NEAR(grid.info.origin.position.y, 2.0, 1e-9);
  EXPECT_NEAR(2.0 * std::asin(grid.info.origin.orientation.z), 0.3, 1e-9);
  EXPECT_THAT(grid.data, ElementsAre(-1, 0, 100, 0, 100, 0));
}

TEST_F(PlanFile, IsConvertedByTheThresholdsOfItsYaml) {
  const std::string lies = "image: plan.pgm\nresolution: 0.5\norigin: [0, 0, 0]\n";
  const auto grid = [&](const std::string& fields) {
    std::ofstream(folder_ / "plan.yaml") << lies + fields;
    return grid_of(read_floor_plan(folder_ / "plan.yaml")).data;
  };
  EXPECT_THAT(grid("negate: 1\n"), ElementsAre(-1, 100, 0, 100, 0, 100));
  EXPECT_THAT(grid("negate: True\n"), ElementsAre(-1, 100, 0, 100, 0, 100));
  EXPECT_THAT(grid("occupied_thresh: 0.4\n"), ElementsAre(100, 0, 100, 0, 100, 0));
  EXPECT_THAT(grid("mode: raw\n"), ElementsAre(-1, -1, 0, -1, 0, -1));
}

TEST_F(PlanFile, IsRejectedWithNonSquarePixels) {
  std::ofstream(folder_ / "plan.wld") << "0.5\n0\n0\n-0.6\n0\n0\n";
  EXPECT_THROW(grid_of(read_floor_plan(folder_ / "plan.pgm")), InputError);
}

TEST(CloudMessage, ContainsThreeNumbersPerPoint) {
  const ros::PointCloud2 cloud = cloud_message({{}, "map"}, {{1, 2, 3}, {4, 5, 6}});
  EXPECT_EQ(cloud.width, 2u);
  EXPECT_EQ(cloud.row_step, 24u);
  ASSERT_EQ(cloud.data.size(), 24u);
  float y = 0;
  std::memcpy(&y, cloud.data.data() + 16, 4);
  EXPECT_EQ(y, 5.0f);
}

TEST(PathMessage, IsThinnedIfLong) {
  Trajectory trajectory(20'000);
  for (std::size_t i = 0; i < trajectory.size(); ++i) trajectory[i].time = Timestamp(i);
  const ros::Path path = path_message({}, trajectory, [](const Pose& pose) { return pose; });
  EXPECT_GT(path.poses.size(), 3000u);
  EXPECT_LE(path.poses.size(), 5000u);
}

}  // namespace
}  // namespace byre
