#include "byre/slam/session/tracker.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// Tracks frames on the map of the first frame.
class TrackerOnAMap : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = quarter_circle({});
  Mapper mapper_{mission_.rig, {}, simulated_vocabulary()};
  Tracker tracker_{{}};

  void SetUp() override { mapper_.begin(mission_.frames[0], mission_.rig, {}, AnchoredTrajectory({})); }

  Tracker::Scene scene() const { return {mission_.rig, mapper_}; }
  Pose true_pose(std::size_t frame) const {  // in the map of the first frame
    return true_camera_from_world(mission_, frame) * mission_.truth[0].world_from_body;
  }
  AnchoredPose last(std::size_t frame) const {
    const KeyframeId newest = *mapper_.newest_keyframe();
    return {mission_.frames[frame].time, newest, true_pose(frame) * inverse(camera_from_world(mapper_.map(), newest))};
  }
  // Motion up to a frame.
  MotionModel motion_to(std::size_t frame) const {
    MotionModel motion;
    motion.set_velocity(log_pose(true_pose(frame) * inverse(true_pose(frame - 1))) / 0.1);
    motion.add_odometry({});
    return motion;
  }
};

TEST_F(TrackerOnAMap, TracksAFrameByThePredictedMotion) {
  const auto track = tracker_.track(mission_.frames[2], scene(), last(1), motion_to(1));
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(true_pose(2), 0.02, 0.01));
  EXPECT_EQ(track->online_reference, mapper_.newest_keyframe());
  EXPECT_FALSE(track->offline_reference);
}

TEST_F(TrackerOnAMap, LeavesTheMap) {
  const int revision = mapper_.revision();
  const auto first = tracker_.track(mission_.frames[2], scene(), last(1), motion_to(1));
  const auto second = tracker_.track(mission_.frames[2], scene(), last(1), motion_to(1));
  ASSERT_TRUE(first && second);
  EXPECT_EQ(first->tracked.camera_from_world, second->tracked.camera_from_world);
  EXPECT_EQ(mapper_.revision(), revision);
}

TEST_F(TrackerOnAMap, TracksWithoutPredictionAfterAWrongOne) {
  const auto before = tracker_.track(mission_.frames[1], scene(), last(0), {});
  ASSERT_TRUE(before);
  tracker_.note(*before);
  MotionModel astray;
  astray.add_odometry(Pose{rotation_exp({0.0, 0.0, 0.6}), {0.5, 0.5, 0.0}});
  const auto track = tracker_.track(mission_.frames[2], scene(), last(1), astray);
  ASSERT_TRUE(track);
  EXPECT_THAT(track->tracked.camera_from_world, PoseNear(true_pose(2), 0.02, 0.01));
}

TEST_F(TrackerOnAMap, RelocalisesAFrame) {
  const std::vector<HybridTrack> places = tracker_.find(mission_.frames[2], scene()).places;
  ASSERT_EQ(places.size(), 1u);
  const HybridTrack* const found = &places.front();
  EXPECT_THAT(found->tracked.camera_from_world, PoseNear(true_pose(2), 0.02, 0.01));
  EXPECT_TRUE(found->online_reference);
  EXPECT_FALSE(tracker_.is_doubtful(*found, scene()));
}

TEST_F(TrackerOnAMap, IsEmptyForAnEmptyFrame) {
  const Frame blank{mission_.frames[1].time, std::make_shared<const Features>()};
  EXPECT_FALSE(tracker_.track(blank, scene(), last(0), {}));
  EXPECT_THAT(tracker_.find(blank, scene()).places, ::testing::IsEmpty());
}

TEST(TrackerOnAnOfflineMap, RelocalisesInTheOfflineMapFirst) {
  const SimulatedMission mission = quarter_circle({});
  const auto offline = offline_map_of(mission);
  const Mapper mapper(mission.rig, {}, simulated_vocabulary(), offline);
  const Mission way(offline, {});
  const Tracker tracker({});
  const std::vector<HybridTrack> places = tracker.find(mission.frames[6], {mission.rig, mapper, &way}).places;
  ASSERT_EQ(places.size(), 1u);
  const HybridTrack* const found = &places.front();
  EXPECT_TRUE(found->offline_reference);
  EXPECT_FALSE(found->online_reference);
  EXPECT_THAT(found->tracked.camera_from_world, PoseNear(true_camera_from_world(mission, 6), 0.02, 0.01));
}

TEST(LookalikePlace, IsDetectedByFewVisiblePoints) {
  TrackedFrame found;
  found.expected = 1000;
  found.features.resize(46);
  EXPECT_TRUE(is_like_another_place(found));
  found.features.resize(170);
  EXPECT_FALSE(is_like_another_place(found));
}

}  // namespace
}  // namespace byre
