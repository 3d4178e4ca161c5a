#include "byre/slam/window/paged_features.h"

#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"

#include <algorithm>
#include <ranges>
#include <vector>

#include <gtest/gtest.h>

namespace byre {
namespace {

// Features of a stored map with patches.
std::shared_ptr<const Features> some_features() {
  const StoredMap stored = StoredMapScene(5, 20).stored();
  return stored.map.find_keyframe({Origin::offline, 0})->frame.features;
}

bool is_paged_out(std::span<const std::byte> list, const ScratchFile& file) {
  return list.empty() || file.holds(list.data());
}

void expect_same(const Features& features, const Features& expected) {
  ASSERT_EQ(features.size(), expected.size());
  EXPECT_TRUE(std::ranges::equal(features.descriptors(), expected.descriptors()));
  for (int i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(features.keypoint(i).pixel, expected.keypoint(i).pixel);
    EXPECT_EQ(features.keypoint(i).octave, expected.keypoint(i).octave);
    const Patch *const patch = features.find_patch(i), *const expected_patch = expected.find_patch(i);
    ASSERT_EQ(patch == nullptr, expected_patch == nullptr);
    if (patch == nullptr) continue;
    EXPECT_EQ(patch->pixels, expected_patch->pixels);
    EXPECT_EQ(patch->centre, expected_patch->centre);
  }
  std::vector<int> found, wanted;
  features.visit_area({100.0f, 100.0f}, 90.0f, 0, kOctaves - 1, [&](int i) { found.push_back(i); });
  expected.visit_area({100.0f, 100.0f}, 90.0f, 0, kOctaves - 1, [&](int i) { wanted.push_back(i); });
  EXPECT_EQ(found, wanted);
}

TEST(StowedFeatures, AreEqualInTheMap) {
  StoredMap stored = StoredMapScene(5, 20).stored();
  const auto bytes = write_map(stored);
  ScratchFile file;
  page_out_features(stored.map, file);
  file.release_pages();
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    for (const auto list : stored.map.find_keyframe(id)->frame.features->arrays())
      EXPECT_TRUE(is_paged_out(list, file));
  }
  EXPECT_EQ(write_map(stored), bytes);
}

TEST(StowedFeatures, OutliveTheirFileAndTheOriginals) {
  auto features = some_features();
  const Features kept = *features;
  std::shared_ptr<const Features> put;
  {
    ScratchFile file;
    put = page_out(features, file);
    ASSERT_NE(put, features);
  }
  features.reset();
  expect_same(*put, kept);
}

TEST(StowedFeatures, AreStoredOnce) {
  ScratchFile file;
  const auto once = page_out(some_features(), file);
  const std::size_t bytes = file.bytes_on_disk();
  EXPECT_EQ(page_out(once, file), once);
  EXPECT_EQ(file.bytes_on_disk(), bytes);
}

TEST(StowedFeatures, CopyMovedKeypointsUntilStoredAgain) {
  const auto features = some_features();
  ScratchFile file;
  const auto put = page_out(features, file);
  std::vector<Keypoint> keypoints = to_vector(features->keypoints());
  for (Keypoint& keypoint : keypoints) keypoint.pixel.x() += 1.0f;
  const auto moved = std::make_shared<const Features>(put->moved(keypoints));
  const Features expected = features->moved(keypoints);
  expect_same(*moved, expected);
  EXPECT_FALSE(is_paged_out(std::as_bytes(moved->keypoints()), file));
  EXPECT_EQ(moved->patches().data(), put->patches().data());
  EXPECT_EQ(moved->descriptors().data(), put->descriptors().data());

  const auto again = page_out(moved, file);
  expect_same(*again, expected);
  EXPECT_TRUE(is_paged_out(std::as_bytes(again->keypoints()), file));
  EXPECT_EQ(again->patches().data(), put->patches().data()) << "stored patches are not moved";
}

TEST(StowedFeatures, AreRefilledInTheirOwnMemory) {
  const auto features = some_features();
  ScratchFile file;
  Features refilled = *page_out(features, file);
  refilled.refill_moved(*features, to_vector(features->keypoints()));
  expect_same(refilled, *features);
  EXPECT_FALSE(is_paged_out(std::as_bytes(refilled.keypoints()), file));
  EXPECT_FALSE(is_paged_out(std::as_bytes(refilled.descriptors()), file));
}

TEST(StowedFeatures, AreEmptyWithoutFeatures) {
  ScratchFile file;
  EXPECT_EQ(page_out(nullptr, file), nullptr);
  const auto none = std::make_shared<const Features>();
  EXPECT_EQ(page_out(none, file), none);
}

}  // namespace
}  // namespace byre
