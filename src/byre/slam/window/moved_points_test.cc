#include "byre/slam/window/moved_points.h"

#include <vector>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr PointId kShelf{Origin::offline, 7};
constexpr PointId kWall{Origin::offline, 3};

TEST(MovedPoints, SuspendsAPointThatIsElsewhereInEnoughFrames) {
  MovedPoints moved_points({.frames = 3});
  for (int frame = 0; frame < 2; ++frame) moved_points.note(std::vector{kWall}, std::vector{kShelf});
  EXPECT_FALSE(moved_points.is_suspended(kShelf));
  moved_points.note(std::vector{kWall}, std::vector{kShelf});
  EXPECT_TRUE(moved_points.is_suspended(kShelf));
  EXPECT_FALSE(moved_points.is_suspended(kWall));
  EXPECT_EQ(moved_points.count(), 1);
}

TEST(MovedPoints, RestoresAPointThatIsInPlaceAsOften) {
  MovedPoints moved_points({.frames = 3});
  for (int frame = 0; frame < 20; ++frame) {
    moved_points.note({}, std::vector{kShelf});
    moved_points.note(std::vector{kShelf}, {});
  }
  EXPECT_FALSE(moved_points.is_suspended(kShelf));
}

TEST(MovedPoints, RequiresSeveralFramesInPlaceToRestoreAPoint) {
  MovedPoints moved_points({.frames = 1, .frames_to_return = 3});
  moved_points.note({}, std::vector{kShelf});
  for (int look = 0; look < 20; ++look) {
    moved_points.note_retest(std::vector{kShelf}, {});
    moved_points.note_retest(std::vector{kShelf}, {});
    moved_points.note_retest({}, std::vector{kShelf});
  }
  EXPECT_TRUE(moved_points.is_suspended(kShelf));
  for (int look = 0; look < 3; ++look) moved_points.note_retest(std::vector{kShelf}, {});
  EXPECT_FALSE(moved_points.is_suspended(kShelf));
  EXPECT_EQ(moved_points.count(), 0);
}

TEST(MovedPoints, IgnoresOnlinePointsOfTheSameNumber) {
  MovedPoints moved_points({.frames = 1});
  moved_points.note({}, std::vector{kShelf});
  EXPECT_FALSE(moved_points.is_suspended({Origin::online, kShelf.number}));
}

// A row of points half a metre apart, numbered from 0.
MapGraph row_of_points(int count) {
  MapGraph map(Origin::offline);
  for (int i = 0; i < count; ++i) {
    MapPoint point;
    point.position_in_world = {0.5 * i, 0.0, 0.0};
    map.add_point(point);
  }
  return map;
}

TEST(MovedTogether, KeepsClustersAndDropsSinglePoints) {
  const MapGraph map = row_of_points(30);
  std::vector<PointId> agreed, moved;
  for (const PointId id : map.point_ids()) {
    const bool in_thing = id.number >= 20;
    const bool alone = id.number == 5 || id.number == 12;
    (in_thing || alone ? moved : agreed).push_back(id);
  }
  const ScratchVector<PointId> together = moved_together(map, agreed, moved);
  EXPECT_THAT(together, testing::SizeIs(testing::Ge(9U)));
  EXPECT_THAT(together, testing::Each(testing::Field(&PointId::number, testing::Ge(20U))));
}

TEST(MovedTogether, IsEmptyForOnePoint) {
  const MapGraph map = row_of_points(1);
  EXPECT_THAT(moved_together(map, {}, map.point_ids()), testing::IsEmpty());
}

}  // namespace
}  // namespace byre
