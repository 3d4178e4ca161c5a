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

TEST(Suspension, LastsForTheMission) {
  Suspension suspension({.frames = 1});
  suspension.note({}, std::vector{kShelf});
  for (int frame = 0; frame < 20; ++frame) suspension.note(std::vector{kShelf}, {});
  EXPECT_TRUE(suspension.is_suspended(kShelf));
}

TEST(Suspension, NeverConcernsOnlinePointsOfTheSameNumber) {
  Suspension suspension({.frames = 1});
  suspension.note({}, std::vector{kShelf});
  EXPECT_FALSE(suspension.is_suspended({Origin::online, kShelf.number}));
}

}  // namespace
}  // namespace byre
