#include "byre/base/object_pool.h"
#include "byre/features.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace byre {
namespace {

struct Parts {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  std::vector<Patch> patches;
};

Parts parts_of(int count, int seed) {
  Parts parts;
  for (int i = 0; i < count; ++i) {
    Keypoint keypoint;
    keypoint.pixel = {static_cast<float>((37 * i + 11 * seed) % 320), static_cast<float>((53 * i + seed) % 240)};
    parts.keypoints.push_back(keypoint);
    parts.descriptors.push_back({static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(seed), 0, 0});
    parts.patches.emplace_back().pixels.fill(static_cast<std::uint8_t>(i + seed));
  }
  return parts;
}

struct Pools {
  ObjectPool<Features> features;
  ObjectPool<std::vector<Patch>> patches;

  std::shared_ptr<const Features> refilled(const Parts& parts) {
    const std::shared_ptr<std::vector<Patch>>& of_frame = patches.take();
    *of_frame = parts.patches;
    const std::shared_ptr<Features>& made = features.take();
    made->refill(320, 240, parts.keypoints, parts.descriptors, of_frame);
    return made;
  }
};

void expect_same(const Features& features, const Features& expected) {
  ASSERT_EQ(features.size(), expected.size());
  EXPECT_TRUE(std::ranges::equal(features.descriptors(), expected.descriptors()));
  for (int i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(features.keypoint(i).pixel, expected.keypoint(i).pixel);
    ASSERT_EQ(features.find_patch(i) == nullptr, expected.find_patch(i) == nullptr);
    if (expected.find_patch(i) == nullptr) continue;
    EXPECT_EQ(features.find_patch(i)->pixels, expected.find_patch(i)->pixels);
  }
  std::vector<int> found, wanted;
  features.visit_area({100.0f, 100.0f}, 60.0f, 0, 7, [&](int i) { found.push_back(i); });
  expected.visit_area({100.0f, 100.0f}, 60.0f, 0, 7, [&](int i) { wanted.push_back(i); });
  EXPECT_EQ(found, wanted);
}

Features features_from(Parts parts) {
  return {320, 240, std::move(parts.keypoints), std::move(parts.descriptors), std::move(parts.patches)};
}

TEST(RefilledFeatures, EqualsTheConstructor) {
  Pools pool;
  for (const int count : {50, 0, 90, 20, 1})
    expect_same(*pool.refilled(parts_of(count, 3)), features_from(parts_of(count, 3)));
  Parts without = parts_of(30, 1);
  without.patches.clear();
  expect_same(*pool.refilled(without), features_from(without));
}

TEST(RefilledFeatures, ReusesUnreferencedMemory) {
  Pools pool;
  const Features* const first = pool.refilled(parts_of(40, 1)).get();
  const Keypoint* const keypoints = first->keypoints().data();
  const auto second = pool.refilled(parts_of(40, 2));
  EXPECT_EQ(second.get(), first);
  EXPECT_EQ(second->keypoints().data(), keypoints);
}

TEST(RefilledFeatures, AlternatesBetweenPatches) {
  Pools pool;
  std::set<const Patch*> seen;
  for (int seed = 0; seed < 10; ++seed) seen.insert(pool.refilled(parts_of(40, seed))->find_patch(0));
  EXPECT_LE(seen.size(), 3u) << "features hold the patches of a frame until the next one";
}

TEST(RefilledFeatures, LeavesReferencedFeatures) {
  Pools pool;
  std::vector<std::shared_ptr<const Features>> held;
  for (int seed = 0; seed < 10; ++seed) held.push_back(pool.refilled(parts_of(40, seed)));
  for (int seed = 0; seed < 10; ++seed) {
    expect_same(*held[static_cast<std::size_t>(seed)], features_from(parts_of(40, seed)));
  }
}

TEST(RefilledFeatures, LeavesPatchesSharedByCopies) {
  Pools pool;
  const Features copy = pool.refilled(parts_of(40, 1))->moved(to_vector(features_from(parts_of(40, 1)).keypoints()));
  pool.refilled(parts_of(40, 2));
  expect_same(copy, features_from(parts_of(40, 1)));
}

TEST(RefilledFeatures, MovesFeaturesIntoExistingMemory) {
  Pools pool;
  const Features features = features_from(parts_of(40, 1));
  std::vector<Keypoint> keypoints = to_vector(features.keypoints());
  for (Keypoint& keypoint : keypoints) keypoint.pixel.x() = std::min(319.0f, keypoint.pixel.x() + 3.0f);
  for (int i = 0; i < 2; ++i) {
    const std::shared_ptr<Features>& moved = pool.features.take();
    moved->refill_moved(features, keypoints);
    expect_same(*moved, features.moved(keypoints));
  }
}

}  // namespace
}  // namespace byre
