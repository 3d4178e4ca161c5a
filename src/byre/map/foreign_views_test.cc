// Views of online points by offline keyframes, and the online map without them.

#include "byre/map/map_view.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kFeatures = 4;
constexpr KeyframeId kOld{Origin::offline, 7}, kOlder{Origin::offline, 3};

Keyframe keyframe_with_features() {
  Keyframe keyframe;
  keyframe.frame.features =
      std::make_shared<Features>(640, 480, std::vector<Keypoint>(kFeatures, Keypoint{{1.0f, 1.0f}}),
                                 std::vector<Descriptor>(kFeatures), std::vector<Patch>{});
  return keyframe;
}

PointId add_sighted_point(MapGraph& map, const Observation& seen) {
  MapPoint point;
  point.reference = seen;
  const PointId id = map.add_point(point);
  map.add_observation(seen, {id});
  return id;
}

MATCHER_P2(IsViewBy, keyframe, feature, "") {
  return arg.observation == Observation{keyframe, feature};
}

class ForeignViews : public ::testing::Test {
 protected:
  ForeignViews() {
    online.add_rig({});
    keyframe = online.add_keyframe(keyframe_with_features());
    first = add_sighted_point(online, {keyframe, 0});
    second = add_sighted_point(online, {keyframe, 1});
  }
  void TearDown() override { EXPECT_THAT(find_faults(online), IsEmpty()); }

  bool add(KeyframeId by, int feature, PointId point) { return online.add_foreign_view({{by, feature}, {point}}); }

  MapGraph online{Origin::online};
  KeyframeId keyframe;
  PointId first, second;
};

TEST_F(ForeignViews, AreSeparateFromObservations) {
  EXPECT_TRUE(add(kOld, 2, first));
  EXPECT_TRUE(add(kOlder, 1, first));
  EXPECT_TRUE(add(kOld, 0, second));
  EXPECT_THAT(online.foreign_views(first), ElementsAre(IsViewBy(kOlder, 1), IsViewBy(kOld, 2)));
  EXPECT_THAT(online.foreign_observations(kOld), ElementsAre(Observation{kOld, 0}, Observation{kOld, 2}));
  EXPECT_EQ(online.point_of_foreign_view({kOld, 2}), first);
  EXPECT_THAT(online.observations(first), ElementsAre(Observation{keyframe, 0}));
  EXPECT_THAT(online.covisible_keyframes(keyframe, 10), IsEmpty());
}

TEST_F(ForeignViews, AreVisitedAfterObservations) {
  add(kOld, 2, first);
  std::vector<Observation> visited;
  MapView(online).visit_views(first, [&](const Observation& observation) { visited.push_back(observation); });
  EXPECT_THAT(visited, ElementsAre(Observation{keyframe, 0}, Observation{kOld, 2}));
}

TEST_F(ForeignViews, RejectContradictions) {
  add(kOld, 2, first);
  EXPECT_FALSE(add(kOld, 2, second)) << "the feature sees another point";
  EXPECT_FALSE(add(kOld, 3, first)) << "the keyframe sees the point with another feature";
  EXPECT_FALSE(add(keyframe, 2, first)) << "the keyframe is of this map";
  EXPECT_FALSE(add(kOld, 3, {Origin::online, 99})) << "no such point";
  EXPECT_THAT(online.foreign_views(first), SizeIs(1));
}

TEST_F(ForeignViews, AreRejectedByAnOfflineMap) {
  MapGraph offline(Origin::offline);
  const PointId point = add_sighted_point(offline, {offline.add_keyframe(keyframe_with_features()), 0});
  EXPECT_FALSE(offline.add_foreign_view({{{Origin::online, 0}, 0}, {point}}));
}

TEST_F(ForeignViews, AreRemovedWithTheirPoint) {
  add(kOld, 2, first);
  online.remove_observation({keyframe, 0});  // its last observation; foreign views do not keep a point
  EXPECT_EQ(online.find_point(first), nullptr);
  EXPECT_EQ(online.point_of_foreign_view({kOld, 2}), std::nullopt);
  EXPECT_TRUE(add(kOld, 2, second));
}

TEST_F(ForeignViews, AreRemovable) {
  add(kOld, 2, first);
  add(kOlder, 2, first);
  online.remove_foreign_view({kOld, 2});
  online.remove_foreign_view({kOld, 3});  // no such view
  EXPECT_THAT(online.foreign_views(first), ElementsAre(IsViewBy(kOlder, 2)));
  EXPECT_EQ(online.point_of_foreign_view({kOld, 2}), std::nullopt);
}

TEST(FindFaults, ReportsAForeignViewWithInvalidValues) {
  MapGraph map(Origin::online);
  map.add_rig({});
  const PointId point = add_sighted_point(map, {map.add_keyframe(keyframe_with_features()), 0});
  map.add_foreign_view({{kOld, 0}, {point, {1.0f, 1.0f}, -1.0f}});
  EXPECT_THAT(find_faults(map), ElementsAre(HasSubstr("view by keyframe offline 7 has a sighting")));
}

class StandaloneCopy : public ForeignViews {
 protected:
  StandaloneCopy() {
    const KeyframeId old_keyframe = offline.add_keyframe(keyframe_with_features());
    seen = add_sighted_point(offline, {old_keyframe, 0});
    add_sighted_point(offline, {old_keyframe, 1});  // not observed by the online map
    MapPoint point = *offline.find_point(seen);
    point.position_in_world = {1.0, 2.0, 3.0};
    point.covariance = 0.25 * Eigen::Matrix3d::Identity();
    offline.update_point(seen, point);
    other = online.add_keyframe(keyframe_with_features());
    online.add_observation({other, 3}, {seen, {5.0f, 6.0f}, 0.5f});
    online.add_observation({keyframe, 2}, {seen, {7.0f, 8.0f}, 0.5f});
    add({Origin::offline, 0}, 2, first);
  }

  MapGraph offline{Origin::offline};
  PointId seen;
  KeyframeId other;
};

TEST_F(StandaloneCopy, CopiesTheObservedOfflinePoints) {
  const MapGraph copy = standalone_copy({&offline, online});
  ASSERT_EQ(copy.point_count(), 3);
  const PointId adopted = *copy.find_keyframe(other)->sightings[3].point;
  ASSERT_NE(copy.find_point(adopted), nullptr);
  const MapPoint& point = *copy.find_point(adopted);
  EXPECT_EQ(point.position_in_world, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(point.covariance, (0.25 * Eigen::Matrix3d::Identity()).eval());
  EXPECT_EQ(point.reference, (Observation{keyframe, 2}));
  EXPECT_THAT(copy.observations(adopted), ElementsAre(Observation{keyframe, 2}, Observation{other, 3}));
  EXPECT_EQ(copy.find_keyframe(other)->sightings[3].pixel, Eigen::Vector2f(5.0f, 6.0f));
  EXPECT_THAT(copy.covisible_keyframes(other, 10), SizeIs(1));
}

TEST_F(StandaloneCopy, HasNoReferencesToTheOtherMap) {
  const MapGraph copy = standalone_copy({&offline, online});
  EXPECT_THAT(find_faults(copy), IsEmpty());
  EXPECT_THAT(copy.observations(seen), IsEmpty());
  EXPECT_THAT(copy.foreign_views(first), IsEmpty());
  EXPECT_THAT(copy.foreign_observations({Origin::offline, 0}), IsEmpty());
}

TEST_F(StandaloneCopy, LeavesBothMaps) {
  standalone_copy({&offline, online});
  EXPECT_THAT(online.observations(seen), SizeIs(2));
  EXPECT_THAT(online.foreign_views(first), SizeIs(1));
  EXPECT_EQ(offline.point_count(), 2);
}

}  // namespace
}  // namespace byre
