#include "byre/viewer/plan_picks.h"

#include "byre/input_error.h"
#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::SizeIs;

class PlanPicksTest : public testing::Test {
 protected:
  const StoredMapScene scene_;
  const StoredMap& stored_ = scene_.stored();
};

TEST_F(PlanPicksTest, AreParsedFromThePage) {
  const auto picks =
      parse_plan_picks(R"({"picks": [{"name": "gate, left\n", "point": 3, "plan": [1.5, -2]}]})", stored_.map);
  ASSERT_THAT(picks, SizeIs(1));
  EXPECT_EQ(picks[0].name, "gate  left ");
  EXPECT_EQ(picks[0].point, (PointId{Origin::offline, 3}));
  EXPECT_EQ(picks[0].point_in_plan, Eigen::Vector2d(1.5, -2.0));
}

TEST_F(PlanPicksTest, AreRejectedIfInvalid) {
  for (const char* text : {"", "[]", R"({"picks": 1})", R"({"picks": [{"name": "a", "point": 0}]})",
                           R"({"picks": [{"name": "a", "point": 0, "plan": [1]}]})",
                           R"({"picks": [{"name": "a", "point": "0", "plan": [1, 2]}]})",
                           R"({"picks": [{"name": "a", "point": 999999, "plan": [1, 2]}]})"}) {
    EXPECT_THROW(parse_plan_picks(text, stored_.map), InputError) << text;
  }
}

TEST_F(PlanPicksTest, IncludeTheUncertaintyOfThePoint) {
  const auto found =
      correspondences_of({{"gate", PointId{Origin::offline, 3}, {1.5, -2.0}}}, stored_, DrivingPlane(), 0.05, 0.0);
  const MapPoint& point = *stored_.map.find_point({Origin::offline, 3});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].point_in_map, point.position_in_world);
  EXPECT_EQ(found[0].covariance_in_map, point.covariance);
  EXPECT_EQ(found[0].sigma, 0.05);
}

TEST_F(PlanPicksTest, AreParsedFromPictures) {
  const auto picks = parse_plan_picks(
      R"({"picks": [{"name": "a", "plan": [1, 2], "pixels": [[0, 0.5, 0.5], [1, 0, 1]]},
                    {"name": "b", "plan": [1, 2], "plan_end": [3, 4], "pixels": [[1, 0.5, 0.5], [1, 0, 1]]},
                    {"name": "c", "plan": [1, 2], "station": 1}]})",
      stored_.map);
  ASSERT_THAT(picks, SizeIs(3));
  const Rig& rig = stored_.map.rigs()[0];
  EXPECT_EQ(picks[0].pixels.at(1).keyframe, (KeyframeId{Origin::offline, 1}));
  EXPECT_EQ(picks[0].pixels.at(0).pixel, Eigen::Vector2d(0.5 * rig.width - 0.5, 0.5 * rig.height - 0.5));
  EXPECT_EQ(picks[1].end_in_plan, Eigen::Vector2d(3.0, 4.0));
  EXPECT_EQ(picks[2].station, (KeyframeId{Origin::offline, 1}));
  for (const char* wrong : {R"([[0, 0.5, 0.5]])", R"([[0, 0.5, 0.5], [0, 0.6, 0.5]])", R"([[99999, 0.5, 0.5]])"}) {
    const std::string text = R"({"picks": [{"name": "a", "plan": [1, 2], "pixels": )" + std::string(wrong) + "}]}";
    EXPECT_THROW(parse_plan_picks(text, stored_.map), InputError) << text;
  }
}

TEST_F(PlanPicksTest, AreWrittenAsATable) {
  EXPECT_EQ(picks_csv({{"gate post", PointId{Origin::offline, 3}, {1.5, -2.0}},
                       {"", PointId{Origin::offline, 12}, {400000.12345, 0.0}}},
                      stored_),
            "name,point,time_s,time_ns,u_px,v_px,u_end_px,v_end_px,plan_x_m,plan_y_m,plan_end_x_m,plan_end_y_m\n"
            "gate post,3,,,,,,,1.5000,-2.0000,,\n,12,,,,,,,400000.1235,0.0000,,\n");
}

}  // namespace
}  // namespace byre
