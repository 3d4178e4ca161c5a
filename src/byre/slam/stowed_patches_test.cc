#include "byre/slam/stowed_patches.h"

#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace byre {
namespace {

TEST(StowedPatches, AreTheSameInTheMap) {
  StoredMap stored = StoredMapScene(5, 20).stored();
  const auto bytes = write_map(stored);
  std::vector<const Patch*> before;
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    before.push_back(stored.map.find_keyframe(id)->frame.features->patches().data());
  }
  ScratchFile file;
  stow_patches(stored.map, file);
  file.forget_looks();
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const auto patches = stored.map.find_keyframe(id)->frame.features->patches();
    EXPECT_TRUE(patches.empty() || patches.data() != before[id.number]);
  }
  EXPECT_EQ(write_map(stored), bytes);
}

TEST(StowedPatches, MoveWithTheirFeatures) {
  const StoredMap stored = StoredMapScene(5, 20).stored();
  const auto& features = stored.map.find_keyframe({Origin::offline, 0})->frame.features;
  ASSERT_FALSE(features->patches().empty());
  ScratchFile file;
  const auto stowed = with_stowed_patches(features, file);
  const Features moved = stowed->moved(to_vector(features->keypoints()));
  EXPECT_EQ(moved.patches().data(), stowed->patches().data());
  for (int i = 0; i < moved.size(); ++i) {
    const Patch* const patch = features->find_patch(i);
    ASSERT_EQ(moved.find_patch(i) != nullptr, patch != nullptr);
    if (patch == nullptr) continue;
    EXPECT_EQ(moved.find_patch(i)->pixels, patch->pixels);
    EXPECT_EQ(moved.find_patch(i)->centre, patch->centre);
  }
}

TEST(StowedPatches, AreNoneWhereFeaturesHaveNone) {
  ScratchFile file;
  EXPECT_EQ(with_stowed_patches(nullptr, file), nullptr);
  const auto none = std::make_shared<const Features>();
  EXPECT_EQ(with_stowed_patches(none, file), none);
}

}  // namespace
}  // namespace byre
