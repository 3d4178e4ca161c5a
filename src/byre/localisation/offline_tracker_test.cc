#include "byre/localisation/offline_tracker.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/localisation/place_view_scene.h"
#include "byre/slam/body_pose.h"
#include "byre/slam/place_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A robot that was found in its offline map, at a true pose.
class OnAnOfflineMap : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = quarter_circle({});
  const std::shared_ptr<const OfflineMap> map_ = offline_map_of(mission_);
  Mapper mapper_{mission_.rig, {}, {.local = make_inline_executor()}, {simulated_vocabulary(), map_}};
  OfflineTracker tracker_{map_, {}, {make_inline_executor(), make_inline_executor()}};
  Whereabouts whereabouts_{{}, {}, {}, true};

  HybridTrack track_of(std::size_t frame, int inliers = 100, int expected = 100) const {
    HybridTrack track;
    track.tracked.camera_from_world = true_camera_from_world(mission_, frame);
    track.tracked.reference = map_->map().keyframe_ids()[frame / 4];
    track.offline_reference = track.tracked.reference;
    track.offline_expected = expected;
    track.offline_inliers = inliers;
    return track;
  }
  void note_found(std::size_t frame, const PlaceView& view = view_of_room(10, 0, 2)) {
    mapper_.begin_where_found(track_of(frame));
    for (const bool from_nothing : {true, false, false, false}) {
      whereabouts_.note({mission_.frames[frame], track_of(frame), from_nothing, true, 0, false, &view}, mission_.rig,
                        mapper_.map());
      ++frame;
    }
    ASSERT_TRUE(whereabouts_.place().is_believed());
  }
  OfflineTracker::Consequence note(std::size_t frame, int inliers) {
    return tracker_.note({mission_.frames[frame], track_of(frame, inliers), mission_.rig, 0.1, false, {}, {}},
                         whereabouts_, mapper_);
  }
  struct Way {
    std::size_t begin = 0;    // its first frame
    bool is_by_hint = false;  // it begins at a pose found by a hint; otherwise at an accepted pose
  };
  // The first frame of a way in which a place 5 m away, which shows much more in each, refutes where tracking is; zero
  // where none does.
  std::size_t frame_that_refutes(const Way& way) {
    for (std::size_t i = way.begin; i < mission_.frames.size(); ++i) {
      const HybridTrack track = track_of(i, 50, 1000);
      const PlaceView view = view_of_room(2, 8);
      const bool is_find = way.is_by_hint && i == way.begin;
      whereabouts_.note({mission_.frames[i], track, is_find, true, 0, is_find, &view}, mission_.rig, mapper_.map());
      tracker_.note({mission_.frames[i], track, mission_.rig, 0.1, false, {}, {}}, whereabouts_, mapper_);
      EXPECT_NE(whereabouts_.place().is_accepted(), way.is_by_hint) << i;
      FoundPlace rival{mission_.frames[i].time, true_camera_from_world(mission_, i), 3.0, 8.0};
      rival.camera_from_offline = rival.camera_from_offline * Pose{Eigen::Quaterniond::Identity(), {5.0, 0.0, 0.0}};
      rival.tracked_log_odds = whereabouts_.place().log_odds();
      if (tracker_.consider(rival, whereabouts_, mapper_).refutes_way) return i;
    }
    return 0;
  }
  // A place so many metres beside where the first frame was believed to be.
  FoundPlace place_beside(double metres, double log_odds) const {
    const Pose beside{Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0}};
    return {mission_.frames[0].time, beside * true_camera_from_world(mission_, 0), 3.0, log_odds};
  }
};

TEST_F(OnAnOfflineMap, TellsOnceThatItsPointsHoldThePoseOrDoNot) {
  note_found(0);
  EXPECT_THAT(note(4, 100).events, ElementsAre(SessionEvent::entered_mapped_area));
  EXPECT_THAT(note(5, 100).events, IsEmpty());
  EXPECT_EQ(tracker_.mission().distance_since_offline(), 0.0);
  EXPECT_THAT(note(6, 0).events, IsEmpty()) << "things have changed, which is no news of the robot";
  EXPECT_GT(tracker_.mission().distance_since_offline(), 0.0);
}

TEST_F(OnAnOfflineMap, LetsItsPointsPutTheCameraTheFartherOffTheLongerTheyDidNotHoldIt) {
  note_found(0);
  note(4, 100);
  const Mission& mission = tracker_.mission();
  const HybridLimits at_once = mission.limits(true, 0.1);
  EXPECT_LT(at_once.drift.translation, 1.0) << "metres, and no bay of a building is as short";
  EXPECT_GT(at_once.stray, at_once.drift.translation) << "the robot may have moved unforeseen";
  EXPECT_GT(mission.limits(true, 1.0).stray, at_once.stray);
  for (std::size_t i = 5; i < 10; ++i) note(i, 0);
  ASSERT_GT(mission.distance_since_offline(), 0.0);
  EXPECT_GT(mission.limits(true, 0.1).drift.translation, at_once.drift.translation);
  EXPECT_GT(mission.limits(false, 0.1).drift.translation, mission.limits(true, 0.1).drift.translation);
}

TEST_F(OnAnOfflineMap, ReplacesAPlaceThatIsNotAcceptedByALikelierOne) {
  note_found(0, view_of_room(2, 8));
  ASSERT_FALSE(whereabouts_.place().is_accepted());
  EXPECT_FALSE(tracker_.consider(place_beside(2.0, -5.0), whereabouts_, mapper_).refutes_pose);
  EXPECT_FALSE(tracker_.consider(place_beside(0.1, 5.0), whereabouts_, mapper_).refutes_pose);
  EXPECT_TRUE(tracker_.consider(place_beside(2.0, 5.0), whereabouts_, mapper_).refutes_pose);
}

TEST_F(OnAnOfflineMap, KeepsAnAcceptedPlaceAfterOneFindElsewhere) {
  note_found(0);
  ASSERT_TRUE(whereabouts_.place().is_accepted());
  const OfflineTracker::Consequence consequence = tracker_.consider(place_beside(2.0, 5.0), whereabouts_, mapper_);
  EXPECT_FALSE(consequence.refutes_pose);
  EXPECT_FALSE(consequence.correction);
}

TEST_F(OnAnOfflineMap, GivesUpAnAcceptedPlaceForARivalFoundAllAlongTheWay) {
  note_found(0);
  ASSERT_TRUE(whereabouts_.place().is_accepted());
  EXPECT_GT(frame_that_refutes({.begin = 4, .is_by_hint = false}), 8U) << "not by one find";
}

TEST_F(OnAnOfflineMap, KeepsAPlaceFoundByAHintUntilARivalIsFoundAllAlongTheWay) {
  mapper_.begin_where_found(track_of(0));
  EXPECT_GT(frame_that_refutes({.begin = 0, .is_by_hint = true}), 8U) << "not by one find";
}

TEST_F(OnAnOfflineMap, AsksForNoMoreProofWhereAHintAndAllElseAgree) {
  mapper_.begin_where_found(track_of(0));
  for (std::size_t i = 0; i < 4; ++i) {
    const PlaceView view = view_of_room(2, 4);
    whereabouts_.note({mission_.frames[i], track_of(i), i == 0, true, 0, true, &view}, mission_.rig, mapper_.map());
  }
  tracker_.search_beside({mission_.frames[3], mission_.rig, PoseHint{}}, whereabouts_, mapper_);
  const auto found = tracker_.collect_place().found;
  ASSERT_TRUE(found) << "in the whole map, for the hint says that the robot is elsewhere";
  EXPECT_TRUE(tracker_.consider(*found, whereabouts_, mapper_).agrees_with_hint);
}

TEST_F(OnAnOfflineMap, CorrectsTheOnlineMapOnceEnoughPlacesAgreeWithinDrift) {
  note_found(0);
  const int confirmations = RegistrationOptions{}.confirmations;
  for (int i = 1; i < confirmations; ++i) {
    EXPECT_FALSE(tracker_.consider(place_beside(0.005, 5.0), whereabouts_, mapper_).correction);
  }
  const auto correction = tracker_.consider(place_beside(0.005, 5.0), whereabouts_, mapper_).correction;
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->shape, CorrectionShape::spread);
  EXPECT_EQ(correction->frame, Submaps::kMapFrame);
  EXPECT_NEAR(correction->offline_from_online.translation.norm(), 0.005, 1e-6);
}

TEST_F(OnAnOfflineMap, LooksForPlacesWhileItsPointsDoNotHoldThePoseBeyondDoubt) {
  note_found(0, view_of_room(2, 8));
  tracker_.search_beside({mission_.frames[4], mission_.rig}, whereabouts_, mapper_);
  const auto found = tracker_.collect_place().found;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->time, mission_.frames[4].time);
  EXPECT_THAT(found->camera_from_offline, PoseNear(true_camera_from_world(mission_, 4), 0.02, 0.01));
}

TEST_F(OnAnOfflineMap, LooksForPlacesOnceASecondWhereFewOfItsPointsAreSeen) {
  note_found(0);
  const PlaceView view = view_of_room(3, 7);
  for (int i = 0; i < 6; ++i) {
    whereabouts_.note({mission_.frames[4], track_of(4), false, true, 0, false, &view}, mission_.rig, mapper_.map());
  }
  ASSERT_TRUE(whereabouts_.place().is_accepted());
  note(4, 70);
  tracker_.search_beside({mission_.frames[4], mission_.rig}, whereabouts_, mapper_);
  const auto found = tracker_.collect_place().found;
  ASSERT_TRUE(found);
  EXPECT_EQ(found->tracked_log_odds, whereabouts_.place().log_odds());
  tracker_.search_beside({mission_.frames[5], mission_.rig}, whereabouts_, mapper_);
  EXPECT_FALSE(tracker_.collect_place().found);
}

TEST_F(OnAnOfflineMap, LooksForNoPlacesWhileTheyDo) {
  note_found(0);
  note(4, 100);
  tracker_.search_beside({mission_.frames[4], mission_.rig}, whereabouts_, mapper_);
  EXPECT_FALSE(tracker_.collect_place().found);
}

}  // namespace
}  // namespace byre
