#include "byre/slam/suspension.h"

#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr PointId kShelf{Origin::offline, 7};
constexpr PointId kWall{Origin::offline, 3};

TEST(Suspension, LeavesOutAPointThatIsElsewhereInEnoughFrames) {
  Suspension suspension({.frames = 3});
  for (int frame = 0; frame < 2; ++frame) suspension.note(std::vector{kWall}, std::vector{kShelf});
  EXPECT_FALSE(suspension.is_suspended(kShelf));
  suspension.note(std::vector{kWall}, std::vector{kShelf});
  EXPECT_TRUE(suspension.is_suspended(kShelf));
  EXPECT_FALSE(suspension.is_suspended(kWall));
  EXPECT_EQ(suspension.count(), 1);
}

TEST(Suspension, ForgivesAPointThatIsFoundInItsPlaceAsOften) {
  Suspension suspension({.frames = 3});
  for (int frame = 0; frame < 20; ++frame) {
    suspension.note({}, std::vector{kShelf});
    suspension.note(std::vector{kShelf}, {});
  }
  EXPECT_FALSE(suspension.is_suspended(kShelf));
}

TEST(Suspension, LastsUntilThePointIsFoundInItsPlaceAFewTimesInARow) {
  Suspension suspension({.frames = 1, .frames_to_return = 3});
  suspension.note({}, std::vector{kShelf});
  for (int look = 0; look < 20; ++look) {
    suspension.note_again(std::vector{kShelf}, {});
    suspension.note_again(std::vector{kShelf}, {});
    suspension.note_again({}, std::vector{kShelf});
  }
  EXPECT_TRUE(suspension.is_suspended(kShelf));
  for (int look = 0; look < 3; ++look) suspension.note_again(std::vector{kShelf}, {});
  EXPECT_FALSE(suspension.is_suspended(kShelf));
  EXPECT_EQ(suspension.count(), 0);
}

TEST(Suspension, NeverConcernsOnlinePointsOfTheSameNumber) {
  Suspension suspension({.frames = 1});
  suspension.note({}, std::vector{kShelf});
  EXPECT_FALSE(suspension.is_suspended({Origin::online, kShelf.number}));
}

// A row of points half a metre apart, numbered from 0.
Map row_of_points(int count) {
  Map map(Origin::offline);
  for (int i = 0; i < count; ++i) {
    MapPoint point;
    point.position_in_world = {0.5 * i, 0.0, 0.0};
    map.add_point(point);
  }
  return map;
}

TEST(MovedTogether, KeepsClustersAndNoPointThatDisagreesAlone) {
  const Map map = row_of_points(30);
  std::vector<PointId> agreed, moved;
  for (const PointId id : map.point_ids()) {
    const bool in_thing = id.number >= 20;
    const bool alone = id.number == 5 || id.number == 12;
    (in_thing || alone ? moved : agreed).push_back(id);
  }
  const std::vector<PointId> together = moved_together(map, agreed, moved);
  EXPECT_THAT(together, testing::SizeIs(testing::Ge(9U)));
  EXPECT_THAT(together, testing::Each(testing::Field(&PointId::number, testing::Ge(20U))));
}

TEST(MovedTogether, FindsNoThingInOnePoint) {
  const Map map = row_of_points(1);
  EXPECT_THAT(moved_together(map, {}, map.point_ids()), testing::IsEmpty());
}

}  // namespace
}  // namespace byre
