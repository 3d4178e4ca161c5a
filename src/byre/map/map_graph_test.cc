#include "byre/map/map_graph.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_view.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr int kAll = 1000;

MATCHER_P2(SharesPoints, keyframe, count, "") {
  return arg.keyframe == keyframe && arg.shared_points == count;
}

Keyframe keyframe_with(int feature_count, std::optional<KeyframeId> parent = {}) {
  const auto count = static_cast<std::size_t>(feature_count);
  Keyframe keyframe;
  keyframe.frame.features = std::make_shared<Features>(640, 480, std::vector<Keypoint>(count, Keypoint{{1.0f, 1.0f}}),
                                                       std::vector<Descriptor>(count), std::vector<Patch>{});
  keyframe.parent = parent;
  return keyframe;
}

Keyframe keyframe_at(const Pose& camera_from_world, std::optional<KeyframeId> parent = {}) {
  Keyframe keyframe = keyframe_with(1, parent);
  keyframe.camera_from_world = camera_from_world;
  return keyframe;
}

Pose motion(double x, double yaw) {
  return {rotation_exp({0.0, yaw, 0.0}), {x, 0.1, 0.2}};
}

Rig rig_of_width(int width) {
  Rig rig;
  rig.width = width;
  return rig;
}

PointId add_seen_point(MapGraph& map, const Observation& first) {
  MapPoint point;
  point.reference = first;
  const PointId id = map.add_point(point);
  map.add_observation(first, {id});
  return id;
}

// Three keyframes in a chain, and two points: `shared` is feature 0 of all, `lonely` feature 1 of the last.
class SmallMap : public ::testing::Test {
 protected:
  SmallMap() {
    map.add_rig({});
    first = map.add_keyframe(keyframe_with(3));
    second = map.add_keyframe(keyframe_with(3, first));
    third = map.add_keyframe(keyframe_with(3, second));
    shared = add_seen_point(map, {second, 0});
    map.add_observation({first, 0}, {shared});
    map.add_observation({third, 0}, {shared});
    lonely = add_seen_point(map, {third, 1});
  }
  void TearDown() override { EXPECT_THAT(find_faults(map), IsEmpty()); }

  std::optional<PointId> seen_by(KeyframeId keyframe, std::size_t feature) const {
    return map.find_keyframe(keyframe)->sightings[feature].point;
  }

  MapGraph map{Origin::online};
  KeyframeId first, second, third;
  PointId shared, lonely;
};

TEST(OptionalPoint, ConvertsToAndFromPointIds) {
  EXPECT_EQ(sizeof(OptionalPoint), 4u);
  for (const Origin origin : {Origin::offline, Origin::online}) {
    for (const std::uint32_t number : {0u, 1u, 12345678u, 0x7FFFFFFDu}) {
      const PointId id{origin, number};
      OptionalPoint point = id;
      ASSERT_TRUE(point.has_value());
      EXPECT_EQ(*point, id);
      EXPECT_EQ(point->number, number);
      EXPECT_EQ(std::optional<PointId>(point), id);
      EXPECT_EQ(OptionalPoint(std::optional(id)), point);
      EXPECT_EQ(point, id);
      EXPECT_FALSE(point == (PointId{origin, number ^ 1u}));
      EXPECT_FALSE(point == OptionalPoint());
      point.reset();
      EXPECT_FALSE(point);
    }
  }
}

TEST(OptionalPoint, MayBeEmpty) {
  const std::optional<PointId> none;
  const OptionalPoint point = none;
  EXPECT_FALSE(point.has_value());
  EXPECT_EQ(point, std::nullopt);
  EXPECT_EQ(point, none);
  EXPECT_EQ(std::optional<PointId>(point), std::nullopt);
  EXPECT_FALSE(point == PointId{});
}

TEST_F(SmallMap, KeepsBothEndsOfAnObservation) {
  EXPECT_THAT(map.observations(shared),
              ElementsAre(Observation{first, 0}, Observation{second, 0}, Observation{third, 0}));
  EXPECT_EQ(seen_by(third, 0), shared);
  EXPECT_EQ(seen_by(third, 1), lonely);
}

TEST_F(SmallMap, KeepsTheMeasurementOfASighting) {
  EXPECT_TRUE(map.add_observation({first, 2}, {lonely, {3.5f, 4.5f}, 0.7f}));
  EXPECT_EQ(map.find_keyframe(first)->sightings[2].pixel, Eigen::Vector2f(3.5f, 4.5f));
  EXPECT_EQ(map.find_keyframe(first)->sightings[2].pixel_sigma, 0.7f);
}

TEST_F(SmallMap, MovesSightingsWithTheirFeatures) {
  map.add_observation({first, 2}, {lonely, {3.5f, 4.5f}, 0.7f});
  const Features& before = *map.find_keyframe(first)->frame.features;
  const Eigen::Vector2f was = before.keypoint(2).pixel;
  std::vector<Keypoint> keypoints = to_vector(before.keypoints());
  keypoints[2].pixel += Eigen::Vector2f(2.0f, -1.0f);
  map.move_features(first, before.moved(keypoints));
  EXPECT_EQ(map.find_keyframe(first)->frame.features->keypoint(2).pixel, was + Eigen::Vector2f(2.0f, -1.0f));
  EXPECT_EQ(map.find_keyframe(first)->sightings[2].pixel, Eigen::Vector2f(5.5f, 3.5f));
  EXPECT_EQ(map.find_keyframe(first)->sightings[2].pixel_sigma, 0.7f);
}

TEST_F(SmallMap, KeepsThePositionOfAFeatureThatLosesItsPoint) {
  map.add_observation({first, 2}, {lonely, {3.5f, 4.5f}, 0.7f});
  map.remove_observation({first, 2});
  EXPECT_EQ(seen_by(first, 2), std::nullopt);
  EXPECT_EQ(map.find_keyframe(first)->sightings[2].pixel, Eigen::Vector2f(3.5f, 4.5f));
}

TEST_F(SmallMap, RejectsAContradictoryObservation) {
  EXPECT_FALSE(map.add_observation({third, 1}, {shared})) << "the feature sees another point";
  EXPECT_FALSE(map.add_observation({third, 2}, {shared})) << "the keyframe sees the point with another feature";
  EXPECT_THAT(map.observations(shared), SizeIs(3));
}

TEST_F(SmallMap, RejectsObservationsOfOrByRemovedElements) {
  map.remove_point(lonely);
  map.remove_keyframe(second);
  EXPECT_FALSE(map.add_observation({first, 1}, {lonely}));
  EXPECT_FALSE(map.add_observation({second, 1}, {shared}));
}

TEST_F(SmallMap, DropsAPointWithItsLastObservation) {
  map.remove_observation({third, 1});
  EXPECT_EQ(map.find_point(lonely), nullptr);
  EXPECT_EQ(map.point_count(), 1);
  EXPECT_THAT(map.point_ids(), ElementsAre(shared));
}

TEST_F(SmallMap, ReplacesAReferenceWithItsKeyframe) {
  map.remove_keyframe(second);
  EXPECT_EQ(map.find_point(shared)->reference, (Observation{first, 0}));
}

TEST_F(SmallMap, RepairsTheReferenceOfAnUpdateForAnOlderMap) {
  MapPoint moved = *map.find_point(shared);
  moved.position_in_world = {1.0, 2.0, 3.0};
  map.remove_keyframe(second);
  map.update_point(shared, moved);
  EXPECT_EQ(map.find_point(shared)->position_in_world, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(map.find_point(shared)->reference, (Observation{first, 0}));
}

TEST_F(SmallMap, RemovesPointsSeenOnlyByARemovedKeyframe) {
  map.remove_keyframe(third);
  EXPECT_EQ(map.find_point(lonely), nullptr);
  EXPECT_THAT(map.observations(shared), ElementsAre(Observation{first, 0}, Observation{second, 0}));
}

TEST_F(SmallMap, ClearsTheSightingsOfARemovedPoint) {
  map.remove_point(shared);
  EXPECT_EQ(seen_by(first, 0), std::nullopt);
  EXPECT_THAT(map.observations(shared), IsEmpty());
  EXPECT_THAT(map.covisible_keyframes(first, kAll), IsEmpty());
}

TEST_F(SmallMap, SortsCovisibleKeyframesBySharedPoints) {
  map.add_observation({first, 1}, {lonely});
  EXPECT_THAT(map.covisible_keyframes(first, kAll), ElementsAre(SharesPoints(third, 2), SharesPoints(second, 1)));
  EXPECT_THAT(map.covisible_keyframes(second, kAll), ElementsAre(SharesPoints(first, 1), SharesPoints(third, 1)));
  EXPECT_THAT(map.covisible_keyframes(first, 1), ElementsAre(SharesPoints(third, 2)));
  EXPECT_THAT(map.covisible_keyframes(first, 0), IsEmpty());
}

TEST_F(SmallMap, RemovesAKeyframeFromCovisibility) {
  map.remove_keyframe(second);
  EXPECT_THAT(map.covisible_keyframes(first, kAll), ElementsAre(SharesPoints(third, 1)));
  EXPECT_THAT(map.covisible_keyframes(second, kAll), IsEmpty());
}

TEST_F(SmallMap, PassesChildrenToTheParentOfARemovedKeyframe) {
  map.remove_keyframe(second);
  EXPECT_EQ(map.find_keyframe(second), nullptr);
  EXPECT_EQ(map.find_keyframe(third)->parent, first);
  EXPECT_THAT(map.keyframe_ids(), ElementsAre(first, third));
}

TEST_F(SmallMap, AcceptsAKeyframeWithoutParent) {
  map.remove_keyframe(first);
  EXPECT_NE(map.find_keyframe(first), nullptr);
}

TEST_F(SmallMap, ReplacesTheRemovedParentOfANewKeyframe) {
  map.remove_keyframe(third);
  map.remove_keyframe(second);
  const KeyframeId added = map.add_keyframe(keyframe_with(0, third));
  EXPECT_EQ(map.find_keyframe(added)->parent, first);
}

TEST_F(SmallMap, DropsAParentOutsideTheMap) {
  const KeyframeId unknown = map.add_keyframe(keyframe_with(0, KeyframeId{Origin::online, 99}));
  const KeyframeId foreign = map.add_keyframe(keyframe_with(0, KeyframeId{Origin::offline, 0}));
  EXPECT_EQ(map.find_keyframe(unknown)->parent, std::nullopt);
  EXPECT_EQ(map.find_keyframe(foreign)->parent, std::nullopt);
}

TEST_F(SmallMap, NeverReusesANumber) {
  map.remove_keyframe(third);
  map.remove_point(shared);
  const KeyframeId keyframe = map.add_keyframe(keyframe_with(1, second));
  EXPECT_GT(keyframe, third);
  EXPECT_GT(add_seen_point(map, {keyframe, 0}), lonely);
}

TEST_F(SmallMap, DoesNotFindARemovedPointAfterNewOnes) {
  map.remove_point(shared);
  const PointId next = add_seen_point(map, {first, 2});
  EXPECT_EQ(map.find_point(shared), nullptr);
  EXPECT_THAT(map.observations(shared), IsEmpty());
  EXPECT_THAT(map.observations(next), ElementsAre(Observation{first, 2}));
  EXPECT_THAT(map.observations(lonely), ElementsAre(Observation{third, 1}));
  EXPECT_THAT(map.point_ids(), ElementsAre(lonely, next));
}

TEST_F(SmallMap, KeepsTheRequestedPatchesOnly) {
  Keyframe keyframe = keyframe_with(3, third);
  keyframe.frame.features = std::make_shared<Features>(640, 480, std::vector<Keypoint>(3, Keypoint{{1.0f, 1.0f}}),
                                                       std::vector<Descriptor>(3), std::vector<Patch>(3));
  const KeyframeId id = map.add_keyframe(keyframe);
  const std::vector<int> kept = {1};
  map.keep_patches(id, kept);
  const Features& features = *map.find_keyframe(id)->frame.features;
  EXPECT_EQ(features.find_patch(0), nullptr);
  EXPECT_NE(features.find_patch(1), nullptr);
  EXPECT_NE(keyframe.frame.features->find_patch(0), nullptr) << "others may still use it";
}

TEST_F(SmallMap, AddsTheObservationsOfANewKeyframe) {
  Keyframe keyframe = keyframe_with(5, third);
  keyframe.sightings = {{shared}, {PointId{Origin::online, 99}}, {shared}, {lonely}};
  const KeyframeId added = map.add_keyframe(keyframe);
  const auto& sightings = map.find_keyframe(added)->sightings;
  ASSERT_THAT(sightings, SizeIs(5));
  EXPECT_EQ(sightings[0].point, shared);
  EXPECT_EQ(sightings[1].point, std::nullopt) << "no such point";
  EXPECT_EQ(sightings[2].point, std::nullopt) << "already observed";
  EXPECT_EQ(sightings[3].point, lonely);
  EXPECT_THAT(map.covisible_keyframes(added, kAll),
              ElementsAre(SharesPoints(third, 2), SharesPoints(first, 1), SharesPoints(second, 1)));
}

TEST_F(SmallMap, KeepsObservationsOfOfflinePoints) {
  const PointId offline{Origin::offline, 3};
  EXPECT_TRUE(map.add_observation({second, 1}, {offline}));
  EXPECT_TRUE(map.add_observation({first, 1}, {offline}));
  EXPECT_THAT(map.observations(offline), ElementsAre(Observation{first, 1}, Observation{second, 1}));
  EXPECT_EQ(map.find_point(offline), nullptr) << "the point belongs to the other map";
  map.remove_observation({first, 1});
  map.remove_keyframe(second);
  EXPECT_THAT(map.observations(offline), IsEmpty());
}

TEST_F(SmallMap, IgnoresChangesToRemovedElements) {
  map.remove_keyframe(second);
  map.remove_point(lonely);
  map.remove_keyframe(second);
  map.remove_point(lonely);
  map.remove_observation({second, 0});
  map.move_keyframe(second, motion(1.0, 0.0), Matrix6::Zero());
  map.update_point(lonely, {});
  EXPECT_EQ(map.keyframe_count(), 2);
  EXPECT_EQ(map.point_count(), 1);
}

TEST_F(SmallMap, CopiesAreIndependent) {
  MapGraph copy = map;
  copy.remove_keyframe(second);
  copy.remove_point(lonely);
  copy.move_keyframe(third, motion(5.0, 0.0), Matrix6::Identity());
  EXPECT_THAT(find_faults(copy), IsEmpty());
  EXPECT_EQ(map.keyframe_count(), 3);
  EXPECT_THAT(map.observations(shared), SizeIs(3));
  EXPECT_NE(map.find_point(lonely), nullptr);
  EXPECT_EQ(map.find_keyframe(third)->camera_from_world.translation, Eigen::Vector3d::Zero());
}

TEST(CameraFromWorld, FollowsRemovedKeyframesToTheirMovedAncestor) {
  MapGraph map(Origin::online);
  const KeyframeId root = map.add_keyframe(keyframe_at(motion(0.0, 0.0)));
  const KeyframeId middle = map.add_keyframe(keyframe_at(motion(1.0, 0.3), root));
  const KeyframeId last = map.add_keyframe(keyframe_at(motion(2.0, 0.7), middle));
  const Pose middle_from_root = map.camera_from_world(middle) * inverse(map.camera_from_world(root));
  const Pose last_from_root = map.camera_from_world(last) * inverse(map.camera_from_world(root));
  map.remove_keyframe(last);
  map.remove_keyframe(middle);
  EXPECT_THAT(map.camera_from_world(last), PoseNear(motion(2.0, 0.7), 1e-9, 1e-8));

  const Pose corrected = motion(-3.0, 1.1);
  map.move_keyframe(root, corrected, Matrix6::Zero());
  EXPECT_THAT(map.camera_from_world(last), PoseNear(last_from_root * corrected, 1e-9, 1e-8));
  EXPECT_THAT(map.camera_from_world(middle), PoseNear(middle_from_root * corrected, 1e-9, 1e-8));
}

TEST(ScaleRemovedKeyframe, ScalesOnlyTheDistanceToItsParent) {
  MapGraph map(Origin::online);
  const KeyframeId root = map.add_keyframe(keyframe_at(motion(0.0, 0.0)));
  const KeyframeId removed = map.add_keyframe(keyframe_at(motion(1.0, 0.3), root));
  const KeyframeId kept = map.add_keyframe(keyframe_at(motion(2.0, 0.7), removed));
  map.remove_keyframe(removed);
  EXPECT_EQ(map.living_ancestor(removed), root);
  EXPECT_EQ(map.living_ancestor(kept), kept);
  EXPECT_FALSE(map.living_ancestor(KeyframeId{Origin::online, 3}));

  for (const KeyframeId id : {root, removed, kept}) map.scale_removed_keyframe(id, 1.1);
  EXPECT_THAT(map.camera_from_world(root), PoseNear(motion(0.0, 0.0), 1e-9, 1e-8));
  EXPECT_THAT(map.camera_from_world(kept), PoseNear(motion(2.0, 0.7), 1e-9, 1e-8));
  Pose camera_from_root = motion(1.0, 0.3) * inverse(motion(0.0, 0.0));
  camera_from_root.translation *= 1.1;
  EXPECT_THAT(map.camera_from_world(removed), PoseNear(camera_from_root * motion(0.0, 0.0), 1e-9, 1e-8));
}

TEST(AddRig, StoresEqualRigsOnce) {
  MapGraph map(Origin::online);
  Rig rig = rig_of_width(640);
  EXPECT_EQ(map.add_rig(rig), 0);
  rig.baseline = 0.2;
  EXPECT_EQ(map.add_rig(rig), 1);
  rig.body_from_camera.translation.x() = 0.5;
  EXPECT_EQ(map.add_rig(rig), 2);
  EXPECT_EQ(map.add_rig(map.rigs()[1]), 1);
  EXPECT_THAT(map.rigs(), SizeIs(3));
}

TEST(OfflineMap, ContainsNoOnlinePoints) {
  MapGraph map(Origin::offline);
  map.add_rig({});
  const KeyframeId keyframe = map.add_keyframe(keyframe_with(1));
  EXPECT_EQ(keyframe.origin, Origin::offline);
  EXPECT_FALSE(map.add_observation({keyframe, 0}, {PointId{Origin::online, 0}}));
  EXPECT_THAT(find_faults(map), IsEmpty());
}

TEST(MapView, ReadsBothMaps) {
  MapGraph offline(Origin::offline);
  MapGraph online(Origin::online);
  offline.add_rig(rig_of_width(111));
  online.add_rig(rig_of_width(222));
  const KeyframeId old_keyframe = offline.add_keyframe(keyframe_with(1));
  const KeyframeId new_keyframe = online.add_keyframe(keyframe_with(1));
  const PointId old_point = add_seen_point(offline, {old_keyframe, 0});
  const PointId new_point = add_seen_point(online, {new_keyframe, 0});

  const MapView view(&offline, online);
  EXPECT_EQ(view.find_point(old_point), offline.find_point(old_point));
  EXPECT_EQ(view.find_point(new_point), online.find_point(new_point));
  EXPECT_EQ(view.find_keyframe(old_keyframe), offline.find_keyframe(old_keyframe));
  EXPECT_EQ(view.rig_of(*view.find_keyframe(old_keyframe), old_keyframe).width, 111);
  EXPECT_EQ(view.rig_of(*view.find_keyframe(new_keyframe), new_keyframe).width, 222);
}

TEST(MapView, VisitsObservationsOfAnOfflinePointInBothMaps) {
  MapGraph offline(Origin::offline);
  MapGraph online(Origin::online);
  const KeyframeId old_keyframe = offline.add_keyframe(keyframe_with(1));
  const KeyframeId new_keyframe = online.add_keyframe(keyframe_with(2));
  const PointId old_point = add_seen_point(offline, {old_keyframe, 0});
  online.add_observation({new_keyframe, 1}, {old_point});

  std::vector<Observation> visited;
  const auto collect = [&](const Observation& observation) { visited.push_back(observation); };
  MapView(&offline, online).visit_observations(old_point, collect);
  EXPECT_THAT(visited, ElementsAre(Observation{old_keyframe, 0}, Observation{new_keyframe, 1}));
}

TEST(MapView, FindsNothingWithoutAnOfflineMap) {
  const MapGraph online(Origin::online);
  const MapView view(nullptr, online);
  EXPECT_EQ(view.find_point({Origin::offline, 0}), nullptr);
  EXPECT_EQ(view.find_keyframe({Origin::offline, 0}), nullptr);
  EXPECT_THAT(view.covisible_keyframes({Origin::offline, 0}, kAll), IsEmpty());
}

}  // namespace
}  // namespace byre
