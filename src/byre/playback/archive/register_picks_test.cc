#include "byre/playback/archive/register_map.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/playback/archive/register_scene.h"

#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::SizeIs;

constexpr double kPickSigma = 0.05;

// A map with one keyframe per second, and one point with a sigma of 0.1 m.
StoredMap small_map() {
  MapGraph map(Origin::offline);
  map.add_rig({320, 240, 188.0, 158.0, 119.0, 0.11, {}});
  for (int i = 0; i < 3; ++i) {
    Keyframe keyframe;
    keyframe.frame.time = std::chrono::seconds(100 + i);
    keyframe.camera_from_world.translation.x() = -i;
    keyframe.frame.features = std::make_shared<const Features>(320, 240, std::vector<Keypoint>(1),
                                                               std::vector<Descriptor>(1), std::vector<Patch>{});
    map.add_keyframe(keyframe);
  }
  MapPoint point;
  point.position_in_world << 4.0, 5.0, 6.0;
  point.covariance = 0.01 * Eigen::Matrix3d::Identity();
  point.reference = {{Origin::offline, 0}, 0};
  const PointId id = map.add_point(point);
  map.add_observation(point.reference, {id, {162.0f, 120.0f}, 1.0f});
  StoredMap stored;
  stored.map = map;
  stored.recordings = {{"barn", {{CameraModel::pinhole, 320, 240, 188.0, 188.0, 158.0, 119.0, {}}, {}, {}}, {}, {}}};
  return stored;
}

FloorPlan small_plan() {
  FloorPlan plan;
  plan.metres_per_pixel << 0.1, 0.0, 0.0, -0.1;
  plan.top_left_in_plan << 0.0, 20.0;
  return plan;
}

class RegisterPicks : public testing::Test {
 protected:
  ~RegisterPicks() override { std::filesystem::remove(path_); }

  std::vector<PlanCorrespondence> read(const std::string& content) const {
    std::ofstream(path_) << content;
    return read_plan_correspondences(path_, small_plan(), map_, {kPickSigma, scale_});
  }

  std::string refusal_of(const std::string& content) const {
    try {
      read(content);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }

  StoredMap map_ = small_map();
  double scale_ = 1.0;
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) / ("picks_" + std::to_string(getpid()) + ".csv");
};

TEST_F(RegisterPicks, AreReadFromTheSimulatedBarn) {
  const auto picks = read("#point_x_m,point_y_m,point_z_m,plan_x_m,plan_y_m,name\n1.5,-2,0.25,10.5,3,column 4 south\n");
  ASSERT_THAT(picks, SizeIs(1));
  EXPECT_EQ(picks[0].name, "column 4 south");
  EXPECT_EQ(picks[0].point_in_map, Eigen::Vector3d(1.5, -2.0, 0.25));
  EXPECT_EQ(picks[0].point_in_plan, Eigen::Vector2d(10.5, 3.0));
  EXPECT_EQ(picks[0].sigma, kPickSigma);
}

TEST_F(RegisterPicks, AcceptBothNamesOfMapPositions) {
  const auto picks = read("map_x_m,map_y_m,map_z_m,plan_x_m,plan_y_m\n1.5,-2,0.25,10.5,3\n");
  EXPECT_EQ(picks.at(0).point_in_map, Eigen::Vector3d(1.5, -2.0, 0.25));
}

TEST_F(RegisterPicks, ScalePositionsButNotPoints) {
  scale_ = 2.0;
  const auto picks = read("map_x_m,map_y_m,map_z_m,point,plan_x_m,plan_y_m\n1.5,-2,0.25,,10.5,3\n,,,0,10.5,3\n");
  EXPECT_EQ(picks.at(0).point_in_map, Eigen::Vector3d(3.0, -4.0, 0.5));
  EXPECT_EQ(picks.at(1).point_in_map, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_TRUE(has_positions(path_));
  read("map_x_m,map_y_m,map_z_m,point,plan_x_m,plan_y_m\n,,,0,10.5,3\n");
  EXPECT_FALSE(has_positions(path_));
}

TEST_F(RegisterPicks, AcceptPixelsOfKeyframeImages) {
  const auto picks = read("time_ns,u_px,v_px,plan_x_m,plan_y_m\n100000000000,163,121,1,2\n");
  EXPECT_EQ(picks.at(0).point_in_map, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_F(RegisterPicks, TriangulatePixelsOfSeveralKeyframes) {
  const std::string columns = "name,time_ns,u_px,v_px,plan_x_m,plan_y_m\n";
  const std::string first = columns + "corner,100000000000,189.3333,134.6667,7,8\n";
  const auto picks = read(first + ",102000000000,126.6667,134.6667,,\nother,100000000000,163,121,1,2\n");
  ASSERT_THAT(picks, SizeIs(2));
  EXPECT_EQ(picks[0].name, "corner");
  EXPECT_THAT(picks[0].point_in_map, PointNear(Eigen::Vector3d(1.0, 0.5, 6.0), 1e-3));
  EXPECT_GT(picks[0].covariance_in_map(2, 2), picks[0].covariance_in_map(0, 0));
  EXPECT_EQ(picks[0].point_in_plan, Eigen::Vector2d(7.0, 8.0));
  EXPECT_THAT(refusal_of(first + ",102000000000,126.6667,160,,\n"), HasSubstr(":2: has pixels of different places"));
  EXPECT_THAT(refusal_of(first + ",100000000000,189,134,,\n"), HasSubstr("is seen from too similar directions"));
  EXPECT_THAT(refusal_of(columns + ",100000000000,163,121,,\n"), HasSubstr("does not give its position on the plan"));
}

TEST_F(RegisterPicks, AcceptFeetOfWalls) {
  FloorPlanScene scene;
  map_ = driven_barn(scene);
  map_.recordings[0].calibration.body_from_left = map_.map.rigs()[0].body_from_camera;
  const std::string columns = "time_ns,u_px,v_px,u_end_px,v_end_px,plan_x_m,plan_y_m,plan_end_x_m,plan_end_y_m\n";
  const auto picks = read(columns + "0,100,200,220,200,1,2,3,2\n");
  ASSERT_TRUE(picks.at(0).wall);
  EXPECT_NEAR((scene.plan_from_map * picks[0].point_in_map).z(), 0.0, 1e-6);
  EXPECT_NEAR((scene.plan_from_map * picks[0].wall->end_in_map).z(), 0.0, 1e-6);
  EXPECT_EQ(picks[0].wall->end_in_plan, Eigen::Vector2d(3.0, 2.0));
  EXPECT_THAT(refusal_of(columns + "0,100,50,220,50,1,2,3,2\n"), HasSubstr("has a pixel that shows no floor"));
}

TEST_F(RegisterPicks, AcceptPointsKeyframesAndPixels) {
  const auto picks = read(
      "name,point,time_s,plan_column_px,plan_row_px,plan_x_m,plan_y_m,sigma_m\n"
      "post,0,,10,20,,,0.2\n"
      ",,102.000000001,,,7,8,\n");
  ASSERT_THAT(picks, SizeIs(2));
  EXPECT_EQ(picks[0].point_in_map, Eigen::Vector3d(4.0, 5.0, 6.0));
  EXPECT_THAT(picks[0].point_in_plan, PointNear(Eigen::Vector2d(1.0, 18.0), 1e-12));
  EXPECT_EQ(picks[0].sigma, 0.2);
  EXPECT_TRUE(picks[0].covariance_in_map.isApprox(0.01 * Eigen::Matrix3d::Identity()));
  EXPECT_EQ(picks[1].name, "row 3");
  EXPECT_THAT(picks[1].point_in_map, PointNear(Eigen::Vector3d(2.0, 0.0, 0.0), 1e-12));
  EXPECT_EQ(picks[1].point_in_plan, Eigen::Vector2d(7.0, 8.0));
}

TEST_F(RegisterPicks, HaveOnlyThePickSigmaInAnUnscaledMap) {
  map_.scale = MapScale::unknown;
  const auto picks = read("point,plan_x_m,plan_y_m\n0,1,2\n");
  EXPECT_EQ(picks.at(0).sigma, kPickSigma);
  EXPECT_EQ(picks[0].covariance_in_map.norm(), 0.0);
}

TEST_F(RegisterPicks, AreRejectedIfNotInTheMap) {
  const std::string columns = "point,time_s,time_ns,u_px,v_px,plan_x_m,plan_y_m\n";
  EXPECT_THAT(refusal_of(columns + "7,,,,,1,2\n"), HasSubstr(":2: refers to point 7, which is not in the map"));
  EXPECT_THAT(refusal_of(columns + "0.5,,,,,1,2\n"), HasSubstr("refers to point 0.5"));
  EXPECT_THAT(refusal_of(columns + "-1,,,,,1,2\n"), HasSubstr("refers to point -1"));
  EXPECT_THAT(refusal_of(columns + ",50,,,,1,2\n"),
              HasSubstr("has a time without keyframe (the nearest keyframe is at 100.000000000 s)"));
  EXPECT_THAT(refusal_of(columns + ",,101500000000,163,121,1,2\n"), HasSubstr("has a time without keyframe"));
  EXPECT_THAT(refusal_of(columns + ",,100000000000,163,150,1,2\n"),
              HasSubstr("has a pixel without a map point nearby"));
}

TEST_F(RegisterPicks, AreRejectedWithoutOneMapAndOnePlanPosition) {
  const std::string columns = "point,time_s,plan_x_m,plan_y_m,plan_column_px,plan_row_px\n";
  EXPECT_THAT(refusal_of(columns + "0,101,1,2,,\n"),
              HasSubstr(":2: gives its position in the map twice (fill in point"));
  EXPECT_THAT(refusal_of(columns + ",,1,2,,\n"), HasSubstr(":2: does not give its position in the map (fill in point"));
  EXPECT_THAT(refusal_of(columns + "0,,1,2,3,4\n"), HasSubstr("gives its position on the plan twice"));
  EXPECT_THAT(refusal_of(columns + "0,,,,,\n"), HasSubstr("does not give its position on the plan"));
}

TEST_F(RegisterPicks, AreRejectedWithInvalidNumbers) {
  const std::string columns = "point,time_s,time_ns,map_x_m,map_y_m,map_z_m,plan_x_m,plan_y_m,sigma_m\n";
  EXPECT_THAT(refusal_of(columns + "gate,,,,,,1,2,\n"), HasSubstr("has no number in point"));
  EXPECT_THAT(refusal_of(columns + ",noon,,,,,1,2,\n"), HasSubstr("has no time in seconds in time_s"));
  EXPECT_THAT(refusal_of(columns + ",,1.5,,,,1,2,\n"), HasSubstr("has no integer in time_ns"));
  EXPECT_THAT(refusal_of(columns + ",,,1,2,,1,2,\n"), HasSubstr("has no number in map_z_m"));
  EXPECT_THAT(refusal_of(columns + ",,,1,2,high,1,2,\n"), HasSubstr("has no number in map_z_m"));
  EXPECT_THAT(refusal_of(columns + "0,,,,,,1,2,-1\n"), HasSubstr("has a non-positive sigma_m"));
  EXPECT_THAT(refusal_of("map_x,plan_x_m\n"), HasSubstr("contains the unknown column \"map_x\""));
}

}  // namespace
}  // namespace byre
