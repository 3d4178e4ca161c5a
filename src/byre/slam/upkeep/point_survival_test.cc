#include "byre/slam/upkeep/point_survival.h"

#include "byre/slam/places/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr PointRecord kSeen{20, 9, 0, 10.0f};
constexpr PointRecord kMissed{20, 0, 0, 10.0f};
constexpr PointRecord kElsewhere{20, 0, 8, 10.0f};

Survival after(Survival before, std::initializer_list<PointRecord> missions) {
  for (const PointRecord& record : missions) before = survival_after(before, record);
  return before;
}

TEST(PointSurvival, GrowsBySightingsAndFallsByMisses) {
  EXPECT_GT(after(kSurvivalOfNewPoint, {kSeen}), kSurvivalOfNewPoint);
  EXPECT_LT(after(kSurvivalOfNewPoint, {kMissed}), kSurvivalOfNewPoint);
  EXPECT_LT(after(kSurvivalOfNewPoint, {kElsewhere}), after(kSurvivalOfNewPoint, {kMissed}));
}

TEST(PointSurvival, IsUnchangedByMissionsThatDidNotExpectThePoint) {
  EXPECT_EQ(after(kSurvivalOfNewPoint, {{}}), kSurvivalOfNewPoint);
  EXPECT_EQ(after(kSurvivalOfNewPoint, {{200, 0, 0, 1.5f}}), kSurvivalOfNewPoint)
      << "in the dark, where hardly any point is seen";
}

TEST(PointSurvival, IsBoundedSoThatLongKnownPointsCanVanish) {
  Survival known = kSurvivalOfNewPoint;
  for (int i = 0; i < 100; ++i) known = survival_after(known, kSeen);
  EXPECT_GT(after(known, {kMissed, kMissed}), 0);
  EXPECT_LT(after(known, {kMissed, kMissed, kMissed, kMissed}), -kSurvivalOfNewPoint);
}

TEST(PointsToRetire, AreTheUnlikelyOnes) {
  const MappedPlace place(quarter_circle(without_noise()));
  std::vector<Survival> survival(static_cast<std::size_t>(place.map.point_count()), kSurvivalOfNewPoint);
  EXPECT_THAT(points_to_retire(place.map, survival), IsEmpty());
  survival[3] = survival[7] = -40;
  survival[7] = -60;
  const std::vector<PointId> retired = points_to_retire(place.map, survival);
  ASSERT_EQ(retired.size(), 2u);
  EXPECT_EQ(retired[0].number, 7u);
  EXPECT_EQ(retired[1].number, 3u);
}

// A point, and those within a tenth of its distance from a keyframe that sees it.
TEST(PointsToRetire, AreJudgedWithThoseNearThem) {
  const MappedPlace place(quarter_circle(without_noise()));
  const auto count = static_cast<std::size_t>(place.map.point_count());
  constexpr Survival kDoubtful = -16;
  const PointId point = place.map.point_ids()[3];
  const auto is_retired = [&](Survival own, Survival others) {
    std::vector<Survival> survival(count, others);
    survival[point.number] = own;
    return std::ranges::count(points_to_retire(place.map, survival), point) == 1;
  };
  EXPECT_TRUE(is_retired(-40, kSurvivalOfNewPoint));
  EXPECT_FALSE(is_retired(-40, 80)) << "the others stay";
  EXPECT_FALSE(is_retired(kDoubtful, kSurvivalOfNewPoint));
  EXPECT_TRUE(is_retired(kDoubtful, 0)) << "the others are doubtful too";
  EXPECT_FALSE(is_retired(2, -80)) << "it was seen";
}

TEST(PointsToRetire, LeaveEachKeyframeHalfOfItsPoints) {
  const MappedPlace place(quarter_circle(without_noise()));
  const std::vector<Survival> survival(static_cast<std::size_t>(place.map.point_count()), -80);
  MapGraph map = place.map;
  for (const PointId id : points_to_retire(map, survival)) map.remove_point(id);
  EXPECT_LT(map.point_count(), place.map.point_count());
  const auto points = [](const Keyframe& keyframe) {
    return std::ranges::count_if(keyframe.sightings, [](const Sighting& seen) { return seen.point.has_value(); });
  };
  for (const KeyframeId id : map.keyframe_ids()) {
    EXPECT_GE(2 * points(*map.find_keyframe(id)) + 1, points(*place.map.find_keyframe(id)));
  }
}

}  // namespace
}  // namespace byre
