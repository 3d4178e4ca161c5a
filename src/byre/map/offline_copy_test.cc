#include "byre/map/stored_map_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::Each;
using testing::IsEmpty;
using testing::SizeIs;

KeyframeId keyframe_id(std::uint32_t number) {
  return {Origin::offline, number};
}

int patch_count(const Features& features) {
  int count = 0;
  for (int i = 0; i < features.size(); ++i) count += features.find_patch(i) ? 1 : 0;
  return count;
}

// The scene as an online map of a session, with some of its parts removed.
class OfflineCopy : public testing::Test {
 protected:
  OfflineCopy() {
    for (const Rig& rig : scene_.parts().rigs) online_.add_rig(rig);
    for (MapPoint point : scene_.parts().points) {
      point.reference.keyframe.origin = Origin::online;
      online_.add_point(point);
    }
    for (Keyframe keyframe : scene_.parts().keyframes) {
      if (keyframe.parent) keyframe.parent->origin = Origin::online;
      for (Sighting& sighting : keyframe.sightings) {
        if (sighting.point) sighting.point = PointId{Origin::online, sighting.point->number};
      }
      online_.add_keyframe(keyframe);
    }
  }

  static KeyframeId online_id(std::uint32_t number) { return {Origin::online, number}; }

  StoredMapScene scene_;
  MapGraph online_{Origin::online};
};

TEST_F(OfflineCopy, KeepsNumbersOfAMapWithoutGaps) {
  const MapGraph copy = offline_copy(online_);
  EXPECT_EQ(copy.origin(), Origin::offline);
  EXPECT_EQ(copy.keyframe_ids(), scene_.stored().map.keyframe_ids());
  EXPECT_EQ(copy.point_ids(), scene_.stored().map.point_ids());
  for (const PointId id : copy.point_ids()) {
    EXPECT_EQ(copy.observations(id), scene_.stored().map.observations(id));
    EXPECT_EQ(copy.find_point(id)->reference, scene_.stored().map.find_point(id)->reference);
  }
}

TEST_F(OfflineCopy, OfAConsumedMapIsTheSame) {
  online_.remove_keyframe(online_id(1));
  StoredMap copied = scene_.stored(), taken = scene_.stored();
  copied.map = offline_copy(online_);
  taken.map = offline_copy(std::move(online_));
  EXPECT_EQ(write_map(taken), write_map(copied));
}

TEST_F(OfflineCopy, ClosesGaps) {
  online_.remove_keyframe(online_id(1));
  online_.remove_point({Origin::online, 0});
  const Eigen::Vector3d second_point = online_.find_point({Origin::online, 1})->position_in_world;
  const Timestamp third_time = online_.find_keyframe(online_id(2))->frame.time;

  const MapGraph copy = offline_copy(online_);
  StoredMap stored = scene_.stored();
  stored.map = copy;
  EXPECT_THAT(find_faults(stored), IsEmpty());
  EXPECT_EQ(copy.keyframe_count(), online_.keyframe_count());
  EXPECT_EQ(copy.point_count(), online_.point_count());
  EXPECT_EQ(copy.find_point({Origin::offline, 0})->position_in_world, second_point);
  EXPECT_EQ(copy.find_keyframe(keyframe_id(1))->frame.time, third_time);
  EXPECT_EQ(copy.find_keyframe(keyframe_id(1))->parent, keyframe_id(0)) << "the parent of its removed parent";
}

TEST_F(OfflineCopy, KeepsFeaturesOfPointsAndPatchesOfReferences) {
  const MapGraph copy = offline_copy(online_);
  int patches = 0;
  for (const KeyframeId id : copy.keyframe_ids()) {
    const Keyframe& keyframe = *copy.find_keyframe(id);
    const Features& features = *keyframe.frame.features;
    const Keyframe& original = *scene_.stored().map.find_keyframe(id);
    EXPECT_EQ(features.size(), std::max(0, original.frame.features->size() - 1));  // the last feature has no point
    EXPECT_EQ(keyframe.words.size(), original.words.empty() ? 0 : keyframe.sightings.size());
    patches += patch_count(features);
    for (int i = 0; i < features.size(); ++i) {
      EXPECT_EQ(features.descriptor(i), original.frame.features->descriptor(i));
      const std::optional<PointId> point = keyframe.sightings[static_cast<std::size_t>(i)].point;
      ASSERT_TRUE(point.has_value());
      if (features.find_patch(i)) {
        EXPECT_EQ(copy.find_point(*point)->reference, (Observation{id, i}));
      }
    }
  }
  EXPECT_GT(patches, 0);
}

TEST_F(OfflineCopy, KeepsThePatchOfEveryReference) {
  const MapGraph copy = offline_copy(online_);
  for (const PointId id : copy.point_ids()) {
    const auto& [keyframe, feature] = copy.find_point(id)->reference;
    const Patch* const original = scene_.stored().map.find_keyframe(keyframe)->frame.features->find_patch(feature);
    const Patch* const kept = copy.find_keyframe(keyframe)->frame.features->find_patch(feature);
    ASSERT_EQ(kept == nullptr, original == nullptr);
    if (kept) {
      EXPECT_EQ(kept->pixels, original->pixels);
    }
  }
}

TEST_F(OfflineCopy, DropsSightingsOfAnotherMap) {
  const KeyframeId watcher = online_id(static_cast<std::uint32_t>(online_.keyframe_count()) - 2);
  const auto free_feature = static_cast<int>(online_.find_keyframe(watcher)->sightings.size()) - 1;
  ASSERT_TRUE(online_.add_observation({watcher, free_feature}, {PointId{Origin::offline, 7}, {1.0f, 2.0f}}));
  const MapGraph copy = offline_copy(online_);
  EXPECT_EQ(copy.find_keyframe(keyframe_id(watcher.number))->frame.features->size(), free_feature);
  EXPECT_THAT(find_faults(copy), IsEmpty());
}

TEST_F(OfflineCopy, MakesCovariancesSymmetric) {
  Matrix6 covariance = Matrix6::Identity();
  covariance(0, 1) = 0.1;
  covariance(1, 0) = 0.1 + 1e-15;
  online_.move_keyframe(online_id(0), {}, covariance);
  const Matrix6 copied = offline_copy(online_).find_keyframe(keyframe_id(0))->covariance;
  EXPECT_EQ(copied, copied.transpose());
  EXPECT_EQ(copied(0, 1), 0.1);
}

TEST_F(OfflineCopy, IsIdempotent) {
  StoredMap once = scene_.stored();
  once.map = offline_copy(online_);
  StoredMap twice = once;
  twice.map = offline_copy(once.map);
  EXPECT_EQ(write_map(once), write_map(twice));
}

}  // namespace
}  // namespace byre
