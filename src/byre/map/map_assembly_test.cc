#include "byre/map/stored_map_scene.h"

#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::IsEmpty;

constexpr int kEvery = std::numeric_limits<int>::max();

// The same map, built step by step.
MapGraph grown(const MapParts& parts) {
  MapGraph map(Origin::offline);
  for (const Rig& rig : parts.rigs) map.add_rig(rig);
  for (const MapPoint& point : parts.points) map.add_point(point);
  for (const Keyframe& keyframe : parts.keyframes) map.add_keyframe(keyframe);
  return map;
}

std::vector<std::pair<KeyframeId, int>> covisible(const MapGraph& map, KeyframeId id) {
  std::vector<std::pair<KeyframeId, int>> all;
  for (const auto& [keyframe, shared] : map.covisible_keyframes(id, kEvery)) all.emplace_back(keyframe, shared);
  return all;
}

StoredMap with_map(StoredMap stored, MapGraph map) {
  stored.map = std::move(map);
  return stored;
}

TEST(MapFromParts, EqualsTheIncrementalMap) {
  const StoredMapScene scene(12, 30);
  const MapGraph map(Origin::offline, scene.parts());
  const MapGraph expected = grown(scene.parts());
  EXPECT_THAT(find_faults(map), IsEmpty());
  EXPECT_EQ(write_map(with_map(scene.stored(), map)), write_map(with_map(scene.stored(), expected)));
  for (const PointId id : expected.point_ids()) EXPECT_EQ(map.observations(id), expected.observations(id));
  for (const KeyframeId id : expected.keyframe_ids()) EXPECT_EQ(covisible(map, id), covisible(expected, id));
}

TEST(MapFromParts, RestoresTheChildrenOfKeyframes) {
  const StoredMapScene scene;
  MapGraph map(Origin::offline, scene.parts());
  ASSERT_EQ(map.find_keyframe({Origin::offline, 2})->parent->number, 1u);
  map.remove_keyframe({Origin::offline, 1});
  EXPECT_EQ(map.find_keyframe({Origin::offline, 2})->parent->number, 0u);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

TEST(MapFromParts, MayBeEmpty) {
  const MapGraph map(Origin::online, {});
  EXPECT_EQ(map.keyframe_count(), 0);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

}  // namespace
}  // namespace byre
