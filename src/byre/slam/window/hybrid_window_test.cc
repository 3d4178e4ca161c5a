// Windows of an online map next to an offline one.

#include "byre/slam/window/hybrid_scene.h"

#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::Gt;
using ::testing::IsEmpty;
using ::testing::Not;

constexpr KeyframeId kFirstOnline{Origin::online, 0};
constexpr KeyframeId kNewestOnline{Origin::online, 19};
constexpr WindowOptions kSmallHybrid{
    .movable = 5, .anchors = 4, .offline_anchors = 3, .sightings_in_place_of_anchors = 100000};

const WindowKeyframe& keyframe_of(const MapWindow& window, const WindowObservation& seen) {
  return window.keyframes[static_cast<std::size_t>(seen.keyframe)];
}

int count(const MapWindow& window, bool offline, bool movable) {
  return static_cast<int>(std::ranges::count_if(window.keyframes, [&](const WindowKeyframe& keyframe) {
    return is_offline(keyframe) == offline && keyframe.movable == movable;
  }));
}

class HybridWindow : public ::testing::Test {
 protected:
  MapWindow cut(KeyframeId newest, const WindowOptions& options = kSmallHybrid) const {
    return cut_window(scene_.view(), {newest}, options);
  }

  // First point of a map that an online keyframe sees.
  PointId first_point(KeyframeId id, Origin origin) const {
    const std::vector<Sighting>& sightings = scene_.online.find_keyframe(id)->sightings;
    return *std::ranges::find_if(sightings, [&](const Sighting& sighting) {
              return sighting.point && sighting.point->origin == origin;
            })->point;
  }

  // First feature of an offline keyframe without a point.
  int free_feature(KeyframeId id) const {
    const std::vector<Sighting>& sightings = scene_.offline.find_keyframe(id)->sightings;
    const auto sees_none = [](const Sighting& sighting) { return !sighting.point; };
    return static_cast<int>(std::ranges::find_if(sightings, sees_none) - sightings.begin());
  }

  HybridScene scene_ = true_hybrid_scene({});
};

TEST_F(HybridWindow, NeedsNoOnlineAnchorsWithEnoughOfflinePoints) {
  WindowOptions options = kSmallHybrid;
  options.sightings_in_place_of_anchors = 50;
  const MapWindow window = cut_window(scene_.view(), {kNewestOnline}, options);
  EXPECT_EQ(count(window, false, true), kSmallHybrid.movable);
  EXPECT_EQ(count(window, false, false), 0);
  EXPECT_EQ(count(window, true, false), kSmallHybrid.offline_anchors);
}

TEST_F(HybridWindow, ContainsAnchorsOfBothMaps) {
  const MapWindow window = cut(kNewestOnline);
  EXPECT_EQ(count(window, false, true), kSmallHybrid.movable);
  EXPECT_EQ(count(window, false, false), kSmallHybrid.anchors);
  EXPECT_EQ(count(window, true, false), kSmallHybrid.offline_anchors);
  EXPECT_EQ(count(window, true, true), 0);
  EXPECT_EQ(window.keyframes.front().id, kNewestOnline);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    EXPECT_EQ(keyframe.is_new, keyframe.id == kNewestOnline);
  }
}

TEST_F(HybridWindow, SelectsOfflineKeyframesByCommonPoints) {
  const MapWindow window = cut(kNewestOnline);
  std::set<PointId> seen;
  for (const Sighting& sighting : window.keyframes.front().keyframe.sightings) {
    if (sighting.point) seen.insert(*sighting.point);
  }
  const auto shared = [&](KeyframeId id) {
    return std::ranges::count_if(scene_.offline.find_keyframe(id)->sightings, [&](const Sighting& sighting) {
      return sighting.point && seen.contains(*sighting.point);
    });
  };
  std::vector<std::ptrdiff_t> shares;
  for (const KeyframeId id : scene_.offline.keyframe_ids()) shares.push_back(shared(id));
  std::ranges::sort(shares, std::greater<>{});
  std::size_t next = 0;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (is_offline(keyframe)) {
      EXPECT_EQ(shared(keyframe.id), shares[next++]);
    }
  }
}

TEST_F(HybridWindow, ContainsTheRigsOfBothMaps) {
  Rig other = scene_.first.rig;
  other.baseline *= 2.0;
  MapGraph offline(Origin::offline);
  offline.add_rig(other);
  for (const PointId id : scene_.offline.point_ids()) offline.add_point(*scene_.offline.find_point(id));
  for (const KeyframeId id : scene_.offline.keyframe_ids()) offline.add_keyframe(*scene_.offline.find_keyframe(id));
  const MapWindow window = cut_window({&offline, scene_.online}, {kNewestOnline}, kSmallHybrid);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    EXPECT_EQ(window.rig_of(keyframe).baseline, is_offline(keyframe) ? other.baseline : scene_.first.rig.baseline);
  }
}

TEST_F(HybridWindow, ContainsAllPointsOfMovableAndOfflineKeyframes) {
  const MapWindow window = cut(kNewestOnline);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (keyframe.movable || is_offline(keyframe)) {
      EXPECT_THAT(keyframe.point_of_feature, Each(Not(kPointElsewhere)));
    }
  }
}

TEST_F(HybridWindow, LinksOfflinePointsToTheKeyframesOfBothMaps) {
  const MapWindow window = cut(kNewestOnline);
  int by_online = 0;
  for (const WindowPoint& point : window.points) {
    const std::size_t all =
        scene_.offline.observations(*point.id).size() + scene_.online.observations(*point.id).size();
    EXPECT_EQ(point.observations.size() + static_cast<std::size_t>(point.observations_elsewhere), all);
    if (!is_offline(point)) continue;
    by_online += first_online_observation(window, point) ? 1 : 0;
  }
  EXPECT_THAT(by_online, Gt(50));
}

TEST_F(HybridWindow, LinksForeignViews) {
  const KeyframeId offline = cut(kNewestOnline).keyframes[static_cast<std::size_t>(kSmallHybrid.movable)].id;
  const PointId point = first_point(kNewestOnline, Origin::online);
  const int free = free_feature(offline);
  ASSERT_TRUE(scene_.online.add_foreign_view({{offline, free}, {point, {3.0f, 4.0f}, 0.5f}}));

  const MapWindow window = cut(kNewestOnline);
  const auto linked = std::ranges::find(window.points, std::optional(point), &WindowPoint::id);
  ASSERT_NE(linked, window.points.end());
  const auto seen = std::ranges::find_if(linked->observations, [&](const WindowObservation& observation) {
    return keyframe_of(window, observation).id == offline;
  });
  ASSERT_NE(seen, linked->observations.end());
  const Keyframe& copy = keyframe_of(window, *seen).keyframe;
  EXPECT_EQ(copy.sightings[static_cast<std::size_t>(free)].pixel, Eigen::Vector2f(3.0f, 4.0f));
  EXPECT_EQ(linked->foreign_views_elsewhere, 0);

  WindowOptions without_offline = kSmallHybrid;
  without_offline.offline_anchors = 0;
  const MapWindow alone = cut(kNewestOnline, without_offline);
  EXPECT_EQ(std::ranges::find(alone.points, std::optional(point), &WindowPoint::id)->foreign_views_elsewhere, 1);
}

TEST_F(HybridWindow, MovesTheFirstKeyframeIfOfflinePointsHoldTheFrame) {
  const MapWindow window = cut(kFirstOnline);
  EXPECT_EQ(window.keyframes.front().id, kFirstOnline);
  EXPECT_TRUE(window.keyframes.front().movable);
}

TEST_F(HybridWindow, HoldsTheFirstKeyframeWithFewOfflinePoints) {
  WindowOptions demanding = kSmallHybrid;
  demanding.min_offline_sightings = 1'000'000;
  EXPECT_FALSE(cut(kFirstOnline, demanding).keyframes.front().movable);
}

TEST_F(HybridWindow, HoldsItsOldestKeyframeIfNothingElseIsHeld) {
  WindowOptions demanding = kSmallHybrid;
  demanding.min_offline_sightings = 1'000'000;
  demanding.anchors = 0;
  const MapWindow window = cut(kNewestOnline, demanding);
  const WindowKeyframe* held = nullptr;
  for (const WindowKeyframe& keyframe : window.keyframes) {
    if (is_offline(keyframe) || keyframe.movable) continue;
    EXPECT_EQ(held, nullptr) << "one is enough";
    held = &keyframe;
  }
  ASSERT_NE(held, nullptr);
  for (const WindowKeyframe& keyframe : window.keyframes) {
    EXPECT_TRUE(is_offline(keyframe) || held->id <= keyframe.id);
  }
}

TEST_F(HybridWindow, EqualsTheOnlineWindowFarFromTheOfflineMap) {
  for (const PointId id : scene_.offline.point_ids()) scene_.offline.remove_point(id);
  for (const KeyframeId id : scene_.online.keyframe_ids()) {  // no sightings of offline points
    const std::vector<Sighting> sightings = scene_.online.find_keyframe(id)->sightings;
    for (int feature = 0; feature < static_cast<int>(sightings.size()); ++feature) {
      const auto& point = sightings[static_cast<std::size_t>(feature)].point;
      if (point && point->origin == Origin::offline) scene_.online.remove_observation({id, feature});
    }
  }
  const MapWindow beside = cut(kNewestOnline);
  const MapWindow alone = cut_window(scene_.online, {kNewestOnline}, kSmallHybrid);
  ASSERT_EQ(beside.keyframes.size(), alone.keyframes.size());
  for (std::size_t i = 0; i < alone.keyframes.size(); ++i) {
    EXPECT_EQ(beside.keyframes[i].id, alone.keyframes[i].id);
    EXPECT_EQ(beside.keyframes[i].movable, alone.keyframes[i].movable);
    EXPECT_EQ(beside.keyframes[i].point_of_feature, alone.keyframes[i].point_of_feature);
  }
}

}  // namespace
}  // namespace byre
