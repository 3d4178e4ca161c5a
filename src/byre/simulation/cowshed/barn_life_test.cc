#include "byre/simulation/cowshed/barn_life.h"

#include <algorithm>
#include <map>
#include <tuple>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::Ge;
using testing::Le;

CowshedRecordingOptions first_visit() {
  CowshedRecordingOptions options;
  options.camera.calibration_level = 1.0;
  return options;
}

CowshedOptions barn_at(int visit) {
  return visit_of_life(first_visit(), visit).barn;
}

std::vector<Eigen::Vector3f> places_at(int visit) {
  std::vector<Eigen::Vector3f> places;
  for (const MovableObject& object : build_cowshed(barn_at(visit)).objects) places.push_back(object.position);
  return places;
}

int count_moved(int from, int to) {
  const auto before = places_at(from), after = places_at(to);
  int moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) moved += before[i] != after[i];
  return moved;
}

TEST(BarnLife, LeavesThingsWhereTheLastVisitLeftThem) {
  EXPECT_THAT(count_moved(1, 2), AllOf(Ge(1), Le(12))) << "of 32, a quarter of the tools";
  EXPECT_THAT(count_moved(30, 31), AllOf(Ge(1), Le(12)));
  EXPECT_GE(count_moved(1, 31), 2 * count_moved(30, 31)) << "changes add up";
}

TEST(BarnLife, IsTheSameForEachVisitAlone) {
  EXPECT_EQ(places_at(17), places_at(17));
  EXPECT_EQ(barn_at(17).cows, barn_at(17).cows);
  EXPECT_EQ(visit_of_life(first_visit(), 17).night.light, visit_of_life(first_visit(), 17).night.light);
}

TEST(BarnLife, BeginsByDayWithTheGateClosed) {
  const CowshedRecordingOptions first = visit_of_life(first_visit(), 1);
  EXPECT_EQ(time_of(first.barn), BarnTime::day);
  EXPECT_EQ(gate_of(first.barn), BarnGate::closed);
  EXPECT_EQ(first.dirt, 0.0);
  EXPECT_EQ(first.camera.calibration_level, 1.0);
}

TEST(BarnLife, HasEachLightOften) {
  std::map<std::tuple<BarnTime, bool>, int> lights;
  for (int visit = 2; visit <= 60; ++visit) {
    const CowshedRecordingOptions options = visit_of_life(first_visit(), visit);
    ++lights[{time_of(options.barn), options.night.headlight > 0.0}];
  }
  EXPECT_EQ(lights.size(), 3u);
  for (const auto& [light, visits] : lights) EXPECT_GE(visits, 10);
}

TEST(BarnLife, IsPaintedInWeekFiveAndBuiltOnInWeekSeven) {
  EXPECT_FALSE(barn_at(28).painted);
  EXPECT_TRUE(barn_at(29).painted);
  EXPECT_FALSE(barn_at(42).has_stall);
  EXPECT_TRUE(barn_at(43).has_stall);
  const auto shapes = [](CowshedOptions barn) { return build_cowshed(barn).still.vertices.size(); };
  CowshedOptions barn = barn_at(43);
  const std::size_t with_stall = shapes(barn);
  barn.has_stall = false;
  EXPECT_GT(with_stall, shapes(barn));
}

TEST(BarnLife, PaintsNothingButTheGable) {
  CowshedOptions barn = barn_at(29);
  const QuadMesh painted = build_cowshed(barn).still;
  barn.painted = false;
  const QuadMesh before = build_cowshed(barn).still;
  EXPECT_EQ(painted.vertices, before.vertices);
}

}  // namespace
}  // namespace byre
