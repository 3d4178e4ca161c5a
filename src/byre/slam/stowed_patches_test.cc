#include "byre/slam/stowed_patches.h"

#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"

#include <gtest/gtest.h>

namespace byre {
namespace {

// As a file has it.
StoredMap read_scene() {
  return read_map(write_map(StoredMapScene(5, 20).stored()), "file");
}

int count_patches(const Map& map) {
  int count = 0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Features& features = *map.find_keyframe(id)->frame.features;
    for (int i = 0; i < features.size(); ++i) count += features.find_patch(i) != nullptr ? 1 : 0;
  }
  return count;
}

TEST(StowedPatches, AreNotInTheMapUntilTheyAreGivenBackTheSame) {
  StoredMap stored = read_scene();
  const auto bytes = write_map(stored);
  ASSERT_GT(count_patches(stored.map), 0);
  StowedPatches patches(stored.map);
  EXPECT_EQ(count_patches(stored.map), 0);
  patches.give_back(stored.map);
  EXPECT_EQ(write_map(stored), bytes);
}

TEST(StowedPatches, OfAKeyframeThatIsGoneArePassedOver) {
  StoredMap stored = read_scene();
  const KeyframeId last = stored.map.keyframe_ids()[4];
  StowedPatches patches(stored.map);
  stored.map.remove_keyframe(last);
  const int left = stored.map.keyframe_count();
  patches.give_back(stored.map);
  EXPECT_EQ(stored.map.keyframe_count(), left);
  EXPECT_GT(count_patches(stored.map), 0);
}

TEST(StowedPatches, StayWhereTheyWouldNotBeTheSame) {
  StoredMap stored = StoredMapScene(5, 20).stored();  // noise of 256 grey values
  const int count = count_patches(stored.map);
  StowedPatches patches(stored.map);
  EXPECT_EQ(count_patches(stored.map), count);
  patches.give_back(stored.map);
  EXPECT_EQ(count_patches(stored.map), count);
}

}  // namespace
}  // namespace byre
