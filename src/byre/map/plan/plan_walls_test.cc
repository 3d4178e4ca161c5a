#include "byre/map/plan/plan_walls.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr double kPixel = 0.05;  // metres

// A plan of 10 x 6 m with the origin at its lower left corner.
class PlanOfRooms {
 public:
  PlanOfRooms() {
    plan_.width = 200;
    plan_.height = 120;
    plan_.metres_per_pixel = kPixel * Eigen::Vector2d(1.0, -1.0).asDiagonal();
    plan_.top_left_in_plan = {0.5 * kPixel, 6.0 - 0.5 * kPixel};
    plan_.occupied_threshold = 0.65;
  }

  void draw(double x0, double y0, double x1, double y1, std::int8_t occupancy = kOccupiedPixel) {
    for (int row = 0; row < 120; ++row) {
      for (int column = 0; column < 200; ++column) {
        const Eigen::Vector2d point = plan_.point_at({column, row});
        if (point.x() < x0 || point.x() > x1 || point.y() < y0 || point.y() > y1) continue;
        occupancy_[static_cast<std::size_t>(row * 200 + column)] = occupancy;
      }
    }
  }
  // Walls 0.2 m thick around two adjacent rooms, from 1 to 9 m and 1 to 5 m.
  void draw_two_rooms() {
    draw(1.0, 1.0, 9.0, 1.2);
    draw(1.0, 4.8, 9.0, 5.0);
    for (const double x : {1.0, 4.9, 8.8}) draw(x, 1.0, x + 0.2, 5.0);
  }
  void draw_door(double low = 1.2) { draw(4.8, low, 5.2, low + 0.9, kFreePixel); }

  PlanWalls walls() const { return {plan_, occupancy_}; }

 private:
  FloorPlan plan_;
  std::vector<std::int8_t> occupancy_ = std::vector<std::int8_t>(200 * 120, kFreePixel);
};

const Eigen::Vector2d kWest(3.0, 3.0), kEast(7.0, 3.0);

TEST(PlanWalls, LeaveAStraightPathBetweenUnobstructedPositions) {
  PlanOfRooms rooms;
  const auto way = rooms.walls().path_length_between({kWest, 0.0}, {kEast, 0.0}, 10.0);
  ASSERT_TRUE(way);
  EXPECT_NEAR(*way, 4.0, 0.2);
}

TEST(PlanWalls, LeaveNoPathIntoAClosedRoom) {
  PlanOfRooms rooms;
  rooms.draw_two_rooms();
  EXPECT_FALSE(rooms.walls().path_length_between({kWest, 0.5}, {kEast, 0.5}, 30.0));
  EXPECT_TRUE(rooms.walls().path_length_between({kWest, 2.3}, {kEast, 2.3}, 30.0))
      << "if either position may be behind the wall";
}

TEST(PlanWalls, LeaveAPathThroughADoor) {
  PlanOfRooms rooms;
  rooms.draw_two_rooms();
  rooms.draw_door();
  const auto way = rooms.walls().path_length_between({kWest, 0.0}, {kEast, 0.0}, 10.0);
  ASSERT_TRUE(way);
  EXPECT_NEAR(*way, 2.0 * std::hypot(2.0, 0.9), 0.4);
  EXPECT_FALSE(rooms.walls().path_length_between({kWest, 0.0}, {kEast, 0.0}, 4.1))
      << "the path is too long for the time";
}

TEST(PlanWalls, DoNotLeakIfThinAndSlanting) {
  PlanOfRooms rooms;
  for (double y = 0.0; y < 6.0; y += 0.5 * kPixel) {
    const double x = 3.0 + 0.7 * y;
    rooms.draw(x - 0.6 * kPixel, y - 0.6 * kPixel, x + 0.6 * kPixel, y + 0.6 * kPixel);
  }
  const PlanWalls walls = rooms.walls();
  EXPECT_FALSE(walls.path_length_between({{2.0, 3.0}, 0.0}, {{8.0, 3.0}, 0.0}, 6.2));
}

TEST(PlanWalls, DetectPositionsDeepInside) {
  PlanOfRooms rooms;
  rooms.draw(2.0, 2.0, 6.0, 5.0);
  const PlanWalls walls = rooms.walls();
  EXPECT_FALSE(walls.has_free_cell({{4.0, 3.5}, 0.5}));
  EXPECT_TRUE(walls.has_free_cell({{2.3, 3.5}, 0.5}));
  EXPECT_TRUE(walls.has_free_cell({{40.0, -30.0}, 0.1})) << "off the plan";
}

TEST(PlanWalls, DetectUnreachablePositions) {
  PlanOfRooms rooms;
  rooms.draw_two_rooms();
  PlanWalls walls = rooms.walls();
  const std::vector<std::vector<Eigen::Vector2d>> ways = {{{2.0, 2.0}, {4.0, 2.0}, {4.0, 4.0}}};
  walls.clear_along_paths(ways);
  EXPECT_TRUE(walls.has_reachable_cell({{2.0, 4.0}, 0.3}));
  EXPECT_FALSE(walls.has_reachable_cell({kEast, 0.5}));
  EXPECT_FALSE(walls.has_reachable_cell({{0.4, 3.0}, 0.3})) << "outside of the building";
  EXPECT_FALSE(walls.has_reachable_cell({{-20.0, 3.0}, 0.3})) << "off the plan";
}

TEST(PlanWalls, OpenAlongDrivenPaths) {
  PlanOfRooms rooms;
  rooms.draw_two_rooms();
  PlanWalls walls = rooms.walls();
  const std::vector<std::vector<Eigen::Vector2d>> ways = {{kWest, {4.0, 3.0}, {6.0, 3.1}}};
  walls.clear_along_paths(ways);
  EXPECT_TRUE(walls.has_reachable_cell({kEast, 0.1}));
  const auto way = walls.path_length_between({kWest, 0.0}, {kEast, 0.0}, 5.0);
  ASSERT_TRUE(way);
  EXPECT_NEAR(*way, 4.0, 0.3);
}

TEST(PlanWalls, ConsistOfOccupiedPixelsOnly) {
  PlanOfRooms rooms;
  rooms.draw(4.9, 0.0, 5.0, 6.0, kUnknownPixel);
  rooms.draw(5.0, 0.0, 5.1, 6.0, 99);
  EXPECT_TRUE(rooms.walls().path_length_between({kWest, 0.0}, {kEast, 0.0}, 5.0));
}

}  // namespace
}  // namespace byre
