#include "byre/ros2/node/map_messages.h"

#include "byre/input_error.h"
#include "byre/io/ros/message_matchers.h"
#include "byre/map/plan/driven_scene.h"
#include "byre/map/point_grey.h"
#include "byre/map/stored_map_scene.h"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

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

// Two rows of three cells of 0.5 m, the upper one first; the lower left corner is at (-1, 2) in the plan.
OccupancyGrid two_rows() {
  OccupancyGrid grid;
  grid.plan.width = 3;
  grid.plan.height = 2;
  grid.plan.metres_per_pixel = Eigen::Vector2d(0.5, -0.5).asDiagonal();
  grid.plan.top_left_in_plan = {-0.75, 2.75};
  grid.occupancy = {kFreePixel, kOccupiedPixel, kFreePixel, kUnknownPixel, kFreePixel, kOccupiedPixel};
  grid.plan_from_map = {1.0, {rotation_exp({0.0, 0.0, 0.5 * M_PI}), {0.0, 0.0, 0.25}}};
  return grid;
}

TEST(GridOfMap, BeginsWithTheLowestRowAtTheCornerInThePublishedFrame) {
  const ros::OccupancyGrid on_plan = grid_of(two_rows(), true);
  EXPECT_EQ(on_plan.info.width, 3u);
  EXPECT_EQ(on_plan.info.height, 2u);
  EXPECT_FLOAT_EQ(on_plan.info.resolution, 0.5f);
  EXPECT_THAT(on_plan.data, ElementsAre(-1, 0, 100, 0, 100, 0)) << "-1: unknown";
  EXPECT_NEAR(on_plan.info.origin.position.x, -1.0, 1e-9);
  EXPECT_NEAR(on_plan.info.origin.position.y, 2.0, 1e-9);
  const ros::OccupancyGrid in_map = grid_of(two_rows(), false);
  EXPECT_EQ(in_map.data, on_plan.data);
  EXPECT_NEAR(in_map.info.origin.position.x, 2.0, 1e-9) << "a quarter turn to the right";
  EXPECT_NEAR(in_map.info.origin.position.y, 1.0, 1e-9);
  EXPECT_NEAR(in_map.info.origin.position.z, -0.25, 1e-9);
  EXPECT_NEAR(in_map.info.origin.orientation.z, -std::sqrt(0.5), 1e-9);
}

// Occupancy at a position in the frame of the grid's header; -2 beside the grid.
int occupancy_at(const ros::OccupancyGrid& grid, const Eigen::Vector3d& position) {
  const auto& [at, turn] = grid.info.origin;
  const Pose frame_from_grid{Eigen::Quaterniond(turn.w, turn.x, turn.y, turn.z), {at.x, at.y, at.z}};
  const Eigen::Vector3d in_grid = inverse(frame_from_grid) * position / grid.info.resolution;
  const int column = static_cast<int>(std::floor(in_grid.x())), row = static_cast<int>(std::floor(in_grid.y()));
  const int width = static_cast<int>(grid.info.width), height = static_cast<int>(grid.info.height);
  if (column < 0 || row < 0 || column >= width || row >= height) return -2;
  EXPECT_LT(std::abs(in_grid.z()), 0.1) << "cells above the floor";
  return grid.data[static_cast<std::size_t>(row) * grid.info.width + column];
}

TEST(GridOfMap, IsFreeWhereTheMapWasDriven) {
  std::vector<Pose> path;
  for (int i = 0; i <= 40; ++i) path.push_back(on_floor(0.25 * std::min(i, 20), 0.25 * std::max(0, i - 20), 0.0));
  StoredMap stored;
  stored.map = map_of(path);
  const ros::OccupancyGrid grid = grid_of(stored, true, {});
  for (const Pose& level_from_body : path) {
    EXPECT_EQ(occupancy_at(grid, kMapFromLevel * level_from_body.translation), 0);
  }
  EXPECT_EQ(occupancy_at(grid, kMapFromLevel * Eigen::Vector3d(1.0, 4.0, 0.0)), -1) << "never seen";
  stored.plan.emplace();
  stored.plan->plan_from_map = {1.0,
                                Pose{Eigen::Quaterniond::Identity(), {100.0, 200.0, 0.0}} * inverse(kMapFromLevel)};
  EXPECT_EQ(occupancy_at(grid_of(stored, true, {}), {102.0, 200.0, 0.0}), 0) << "in the frame of the plan";
  EXPECT_EQ(occupancy_at(grid_of(stored, false, {}), kMapFromLevel * Eigen::Vector3d(2.0, 0.0, 0.0)), 0);
}

TEST(GridOfMap, IsRefusedForMapsWithoutScaleOrFloor) {
  const auto fault = [](const StoredMap& stored) {
    try {
      grid_of(stored, true, {});
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  StoredMap stored;
  EXPECT_THAT(fault(stored), HasSubstr("was not driven on a floor"));
  std::vector<Pose> path;
  for (int i = 0; i <= 20; ++i) path.push_back(on_floor(0.25 * i, 0.0, 0.0));
  stored.map = map_of(path);
  EXPECT_EQ(fault(stored), "");
  stored.scale = MapScale::unknown;
  EXPECT_THAT(fault(stored), HasSubstr("has no metric scale"));
}

TEST(CloudMessage, ContainsPositionAndGreyValuePerPoint) {
  const ros::PointCloud2 cloud = cloud_message({{}, "map"}, {{1, 2, 3, 40}, {4, 5, 6, 50}});
  EXPECT_EQ(cloud.width, 2u);
  EXPECT_EQ(cloud.row_step, 32u);
  ASSERT_EQ(cloud.point_fields.size(), 4u);
  EXPECT_EQ(cloud.point_fields[3], (ros::PointField{"intensity", 12, ros::PointField::kFloat32, 1}))
      << "the name by which RViz and Foxglove colour";
  std::vector<float> numbers(8);
  ASSERT_EQ(cloud.data.size(), 32u);
  std::memcpy(numbers.data(), cloud.data.data(), 32);
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 40, 4, 5, 6, 50));
  EXPECT_EQ(cloud_message({}, {}).data.size(), 0u);
}

TEST_F(PlanFile, PointsOfAMapHaveTheGreyValuesOfTheirPatches) {
  const fs::path file = folder_ / "greys.byre";
  save_map(StoredMapScene().stored_with_plan(), file);
  const StoredMap stored = load_map(file);
  const std::vector<CloudPoint> in_map = points_of(file, false), on_plan = points_of(file, true);
  ASSERT_EQ(in_map.size(), static_cast<std::size_t>(stored.map.point_count()));
  std::size_t i = 0, without = 0;
  for (const PointId id : stored.map.point_ids()) {
    const MapPoint& point = *stored.map.find_point(id);
    const auto grey = grey_of(stored.map, point);
    EXPECT_EQ(in_map[i].w(), grey ? static_cast<float>(*grey) : 128.0f);
    EXPECT_EQ(in_map[i].head<3>(), point.position_in_world.cast<float>());
    EXPECT_EQ(on_plan[i].w(), in_map[i].w());
    EXPECT_GT((on_plan[i] - in_map[i]).norm(), 1.0f);
    without += !grey;
    ++i;
  }
  EXPECT_GT(without, 0u);
  EXPECT_LT(without, i);
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
