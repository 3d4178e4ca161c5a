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
  EXPECT_EQ(picks[0].point, 3u);
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
  const auto found = correspondences_of({{"gate", 3, {1.5, -2.0}}}, stored_, 0.05);
  const MapPoint& point = *stored_.map.find_point({Origin::offline, 3});
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].point_in_map, point.position_in_world);
  EXPECT_NEAR(found[0].sigma, std::sqrt(0.05 * 0.05 + 1e-3), 1e-9);
}

TEST_F(PlanPicksTest, AreWrittenAsATable) {
  EXPECT_EQ(picks_csv({{"gate post", 3, {1.5, -2.0}}, {"", 12, {400000.12345, 0.0}}}),
            "name,point,plan_x_m,plan_y_m\ngate post,3,1.5000,-2.0000\n,12,400000.1235,0.0000\n");
}

}  // namespace
}  // namespace byre
