#include "byre/slam/window/window.h"

#include "byre/slam/tracking/mission_scene.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;

constexpr WindowOptions kSmall{.movable = 5, .anchors = 4};

std::vector<KeyframeId> ids_of(const MapWindow& window) {
  std::vector<KeyframeId> ids;
  for (const WindowKeyframe& keyframe : window.keyframes) ids.push_back(keyframe.id);
  return ids;
}

// Empty if each observation occurs once in its keyframe and once in its point.
std::vector<std::string> find_faults(const MapWindow& window) {
  std::vector<std::string> faults;
  std::set<std::pair<int, int>> held_by_points;
  for (std::size_t p = 0; p < window.points.size(); ++p) {
    const WindowPoint& point = window.points[p];
    if (point.removed && !point.observations.empty()) faults.push_back("a removed point is observed");
    for (const WindowObservation& seen : point.observations) {
      const WindowKeyframe& keyframe = window.keyframes[static_cast<std::size_t>(seen.keyframe)];
      if (!held_by_points.emplace(seen.keyframe, seen.feature).second) faults.push_back("a feature sees two points");
      if (keyframe.point_of_feature[static_cast<std::size_t>(seen.feature)] != static_cast<int>(p)) {
        faults.push_back("a keyframe does not know of a point's observation");
      }
    }
  }
  for (std::size_t k = 0; k < window.keyframes.size(); ++k) {
    const std::vector<int>& points = window.keyframes[k].point_of_feature;
    for (std::size_t f = 0; f < points.size(); ++f) {
      if (points[f] >= 0 && !held_by_points.contains({static_cast<int>(k), static_cast<int>(f)})) {
        faults.push_back("a point does not know of a keyframe's observation");
      }
    }
  }
  return faults;
}

class WindowOfATrueMap : public ::testing::Test {
 protected:
  const MapGraph map_ = true_map(quarter_circle({}), 1, Origin::online);
  const KeyframeId newest_{Origin::online, 39};
};

TEST_F(WindowOfATrueMap, IsBoundedForAnyMapSize) {
  const MapWindow window = cut_window(map_, {newest_}, kSmall);
  EXPECT_THAT(window.keyframes, SizeIs(kSmall.movable + kSmall.anchors));
  const std::vector<KeyframeId> ids = ids_of(window);
  EXPECT_THAT(std::set<KeyframeId>(ids.begin(), ids.end()), SizeIs(ids.size()));
}

TEST_F(WindowOfATrueMap, StartsWithTheNewestAndEndsWithTheAnchors) {
  const MapWindow window = cut_window(map_, {{Origin::online, 38}, newest_}, kSmall);
  EXPECT_EQ(window.keyframes[0].id, newest_);
  for (std::size_t i = 0; i < window.keyframes.size(); ++i) {
    EXPECT_EQ(window.keyframes[i].is_new, i < 2);
    EXPECT_EQ(window.keyframes[i].movable, i < static_cast<std::size_t>(kSmall.movable));
  }
}

TEST_F(WindowOfATrueMap, MovesTheKeyframesMostCovisibleWithTheNewest) {
  const MapWindow window = cut_window(map_, {newest_}, kSmall);
  const ScratchVector<Covisible> covisible = map_.covisible_keyframes(newest_, kSmall.movable - 1);
  for (std::size_t i = 0; i < covisible.size(); ++i) EXPECT_EQ(window.keyframes[i + 1].id, covisible[i].keyframe);
}

TEST_F(WindowOfATrueMap, ContainsAllPointsOfItsMovableKeyframes) {
  const MapWindow window = cut_window(map_, {newest_}, kSmall);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (!keyframe.movable) continue;
    EXPECT_THAT(keyframe.point_of_feature, Each(Not(kPointElsewhere)));
    for (std::size_t f = 0; f < keyframe.point_of_feature.size(); ++f) {
      const int point = keyframe.point_of_feature[f];
      const auto& expected = map_.find_keyframe(keyframe.id)->sightings[f].point;
      EXPECT_EQ(point >= 0 ? window.points[static_cast<std::size_t>(point)].id : std::nullopt, expected);
    }
  }
}

TEST_F(WindowOfATrueMap, ContainsOnlyKeyframesThatObserveItsPoints) {
  const MapWindow window = cut_window(map_, {newest_}, kSmall);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    EXPECT_TRUE(std::ranges::any_of(keyframe.point_of_feature, [](int point) { return point >= 0; }));
  }
}

TEST_F(WindowOfATrueMap, CountsOmittedObservations) {
  const MapWindow window = cut_window(map_, {newest_}, kSmall);
  int elsewhere = 0;
  for (const WindowPoint& point : window.points) {
    EXPECT_EQ(point.observations.size() + static_cast<std::size_t>(point.observations_elsewhere),
              map_.observations(*point.id).size());
    elsewhere += point.observations_elsewhere;
  }
  EXPECT_GT(elsewhere, 0);
}

TEST_F(WindowOfATrueMap, NeverMovesTheFirstKeyframe) {
  for (const KeyframeId newest : {KeyframeId{Origin::online, 0}, KeyframeId{Origin::online, 3}}) {
    const MapWindow window = cut_window(map_, {newest}, kSmall);
    const auto first = std::ranges::find(window.keyframes, KeyframeId{Origin::online, 0}, &WindowKeyframe::id);
    ASSERT_NE(first, window.keyframes.end());
    EXPECT_FALSE(first->movable);
  }
}

TEST_F(WindowOfATrueMap, OmitsRemovedNewKeyframes) {
  MapGraph map = map_;
  map.remove_keyframe(newest_);
  const KeyframeId before{Origin::online, 38};
  const MapWindow window = cut_window(map, {before, newest_}, kSmall);
  EXPECT_EQ(window.keyframes[0].id, before);
  EXPECT_THAT(ids_of(window), Not(::testing::Contains(newest_)));
  EXPECT_THAT(find_faults(window), IsEmpty());
}

TEST_F(WindowOfATrueMap, IsEmptyWithoutNewKeyframes) {
  MapGraph map = map_;
  map.remove_keyframe(newest_);
  EXPECT_THAT(cut_window(map, {newest_}, kSmall).keyframes, IsEmpty());
}

TEST_F(WindowOfATrueMap, KeepsBothEndsOfAnObservationConsistent) {
  MapWindow window = cut_window(map_, {newest_}, kSmall);
  ASSERT_THAT(find_faults(window), IsEmpty());
  const WindowObservation seen = window.points[0].observations.front();
  const Sighting sighting = window.keyframes[static_cast<std::size_t>(seen.keyframe)]
                                .keyframe.sightings[static_cast<std::size_t>(seen.feature)];
  remove_observation(window, seen);
  EXPECT_THAT(find_faults(window), IsEmpty());
  add_observation(window, 1, seen, sighting);
  EXPECT_THAT(find_faults(window), IsEmpty());
  remove_point(window, 1);
  EXPECT_THAT(find_faults(window), IsEmpty());
  EXPECT_TRUE(window.points[1].removed);
}

TEST(CutWindow, OfASingleKeyframeHasNoAnchors) {
  const SimulatedMission mission = simulate_mission(simulated_rig(), circling_trajectory(1, 10.0, 2.0, 0.1), {});
  const MapWindow window = cut_window(true_map(mission, 1, Origin::online), {{Origin::online, 0}}, {});
  ASSERT_THAT(window.keyframes, SizeIs(1));
  EXPECT_FALSE(window.keyframes[0].movable);
  EXPECT_THAT(find_faults(window), IsEmpty());
}

}  // namespace
}  // namespace byre
