#include "byre/slam/localisation/offline_tracker.h"

#include "byre/base/job_slot_scene.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_scene.h"
#include "byre/slam/places/place_view_scene.h"
#include "byre/slam/tracking/body_pose.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// A robot at its true pose in an offline map.
class OfflineTrackerTest : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = quarter_circle({});
  const std::shared_ptr<const OfflineMap> map_ = offline_map_of(mission_);
  Mapper mapper_{mission_.rig, {}, simulated_vocabulary(), map_};
  OfflineTracker tracker_{map_, {}};
  PoseFilter pose_filter_{{}, {}, {}, true};

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
    mapper_.begin_at_relocalisation(track_of(frame));
    for (const bool is_relocalised : {true, false, false, false}) {
      pose_filter_.note({mission_.frames[frame], track_of(frame), is_relocalised, true, 0, false, &view}, mission_.rig,
                        mapper_.map());
      ++frame;
    }
    ASSERT_TRUE(pose_filter_.place().is_confirmed());
  }
  OfflineTracker::MissionUpdate note(std::size_t frame, int inliers) {
    return tracker_.note({mission_.frames[frame], track_of(frame, inliers), mission_.rig, 0.1, false, {}, {}},
                         pose_filter_, mapper_);
  }
  std::optional<PlaceSearch> collect_place() {
    run_at_once(tracker_.search_job());
    return tracker_.collect_place();
  }
  // A search that found the first frame so many metres off its confirmed pose.
  PlaceSearch place_beside(double metres) const {
    const Pose beside{Eigen::Quaterniond::Identity(), {metres, 0.0, 0.0}};
    PlaceSearch search{.time = mission_.frames[0].time, .rig = mission_.rig};
    search.found = FoundPlace{beside * true_camera_from_world(mission_, 0), 3.0, view_of_room(10, 0)};
    search.places = {*search.found};
    return search;
  }
  // Tracks frames at a place 5 m off the true one, which the search finds.
  void track_beside(std::size_t begin, std::size_t end) {
    const Pose beside{Eigen::Quaterniond::Identity(), {5.0, 0.0, 0.0}};
    const PlaceView view = view_of_room(2, 8);
    for (std::size_t i = begin; i < end; ++i) {
      HybridTrack track = track_of(i);
      track.tracked.camera_from_world = track.tracked.camera_from_world * beside;
      if (i == 0) mapper_.begin_at_relocalisation(track);
      if (i == 0) tracker_.begin_place(mission_.frames[i].time, track.tracked.camera_from_world);
      const OfflineTracker::Seen seen{mission_.frames[i], track, mission_.rig, 0.1, false, {}, {}};
      tracker_.test_rivals(seen, {}, pose_filter_, mapper_);
      pose_filter_.note(
          {mission_.frames[i], track, i == 0, true, 0, false, &view, nullptr, tracker_.log_odds_of_rivals()},
          mission_.rig, mapper_.map());
      tracker_.note(seen, pose_filter_, mapper_);
      tracker_.search_in_background({mission_.frames[i], mission_.rig}, pose_filter_, mapper_);
      update_ = tracker_.process_search(collect_place(), pose_filter_, mapper_);
    }
  }

  OfflineTracker::MissionUpdate update_;  // update of the last frame of track_beside()
};

TEST_F(OfflineTrackerTest, ReportsEnteringTheMappedAreaOnce) {
  note_found(0);
  EXPECT_THAT(note(4, 100).events, ElementsAre(SessionEvent::entered_mapped_area));
  EXPECT_THAT(note(5, 100).events, IsEmpty());
  EXPECT_EQ(tracker_.mission().distance_since_offline(), 0.0);
  EXPECT_THAT(note(6, 0).events, IsEmpty()) << "changed objects are no event of the robot";
  EXPECT_GT(tracker_.mission().distance_since_offline(), 0.0);
}

TEST_F(OfflineTrackerTest, WidensItsLimitsWithTheTimeWithoutOfflinePoints) {
  note_found(0);
  note(4, 100);
  const Mission& mission = tracker_.mission();
  const HybridLimits at_once = mission.limits(true, 0.1);
  EXPECT_LT(at_once.drift.translation, 1.0) << "metres, less than a bay of a building";
  EXPECT_GT(at_once.stray, at_once.drift.translation) << "the robot may have moved unpredictably";
  EXPECT_GT(mission.limits(true, 1.0).stray, at_once.stray);
  for (std::size_t i = 5; i < 10; ++i) note(i, 0);
  ASSERT_GT(mission.distance_since_offline(), 0.0);
  EXPECT_GT(mission.limits(true, 0.1).drift.translation, at_once.drift.translation);
  EXPECT_GT(mission.limits(false, 0.1).drift.translation, mission.limits(true, 0.1).drift.translation);
}

TEST_F(OfflineTrackerTest, ReplacesAnUnacceptedPlaceByALikelierRival) {
  track_beside(0, 3);
  EXPECT_FALSE(update_.refutes_pose) << "one search is not enough";
  track_beside(3, 6);
  ASSERT_FALSE(pose_filter_.place().is_accepted());
  EXPECT_TRUE(update_.refutes_pose);
  EXPECT_FALSE(update_.refutes_earlier_poses);
  const auto found = tracker_.find_at_rival(mission_.frames[6], mission_.rig, {});
  ASSERT_TRUE(found);
  EXPECT_THAT(found->camera_from_world, PoseNear(true_camera_from_world(mission_, 6), 0.05, 0.02));
  EXPECT_FALSE(tracker_.find_at_rival(mission_.frames[6], mission_.rig, {})) << "returned once only";
}

TEST_F(OfflineTrackerTest, KeepsAnAcceptedPlaceAfterOneContradictingSearch) {
  note_found(0);
  ASSERT_TRUE(pose_filter_.place().is_accepted());
  const OfflineTracker::MissionUpdate update = tracker_.process_search(place_beside(2.0), pose_filter_, mapper_);
  EXPECT_FALSE(update.refutes_pose);
  EXPECT_FALSE(update.correction);
}

// The place of later frames is 1 m off, where most of the map is not seen. A rival is at their true place.
class PathBeforeARival : public OfflineTrackerTest {
 protected:
  bool is_refuted_after(int inliers) {
    constexpr std::size_t kBegin = 7;
    note_found(0);
    for (std::size_t i = 4; i < kBegin; ++i) {
      mapper_.add_keyframe(mission_.frames[i], track_of(i), mission_.rig);
      note(i, inliers);
    }
    PlaceView view = view_of_room(4, 6);
    for (CellInView& cell : view.cells) cell.expected_alone = cell.seen_alone;
    bool is_refuted = false;
    for (std::size_t i = kBegin; i < mission_.frames.size(); ++i) {
      HybridTrack track = track_of(i, 20);
      track.tracked.camera_from_world =
          track.tracked.camera_from_world * Pose{Eigen::Quaterniond::Identity(), {1.0, 0.0, 0.0}};
      const OfflineTracker::Seen seen{mission_.frames[i], track, mission_.rig, 0.1, false, {}, {}};
      tracker_.test_rivals(seen, {}, pose_filter_, mapper_);
      pose_filter_.note({mission_.frames[i], track, false, true, 0, false, &view}, mission_.rig, mapper_.map());
      tracker_.note(seen, pose_filter_, mapper_);
      tracker_.search_in_background({mission_.frames[i], mission_.rig}, pose_filter_, mapper_);
      is_refuted |= tracker_.process_search(collect_place(), pose_filter_, mapper_).refutes_pose;
    }
    EXPECT_TRUE(pose_filter_.place().is_accepted());
    return is_refuted;
  }
};

TEST_F(PathBeforeARival, ShowsNothingWithoutOfflinePoints) {
  EXPECT_TRUE(is_refuted_after(0));
}

TEST_F(PathBeforeARival, OutweighsItWhereOfflinePointsHeldThePose) {
  EXPECT_FALSE(is_refuted_after(100));
}

TEST_F(OfflineTrackerTest, RequiresNoFurtherEvidenceForAConsistentHint) {
  mapper_.begin_at_relocalisation(track_of(0));
  for (std::size_t i = 0; i < 4; ++i) {
    const PlaceView view = view_of_room(2, 4);
    pose_filter_.note({mission_.frames[i], track_of(i), i == 0, true, 0, true, &view}, mission_.rig, mapper_.map());
  }
  tracker_.search_in_background({mission_.frames[3], mission_.rig, PoseHint{}}, pose_filter_, mapper_);
  const std::optional<PlaceSearch> search = collect_place();
  ASSERT_TRUE(search && search->found) << "in the whole map, as the hint is elsewhere";
  EXPECT_TRUE(tracker_.process_search(search, pose_filter_, mapper_).agrees_with_hint);
}

TEST_F(OfflineTrackerTest, CorrectsTheOnlineMapAfterEnoughConsistentPlaces) {
  note_found(0);
  const int confirmations = RegistrationOptions{}.confirmations;
  for (int i = 1; i < confirmations; ++i) {
    EXPECT_FALSE(tracker_.process_search(place_beside(0.005), pose_filter_, mapper_).correction);
  }
  const auto correction = tracker_.process_search(place_beside(0.005), pose_filter_, mapper_).correction;
  ASSERT_TRUE(correction);
  EXPECT_EQ(correction->shape, CorrectionShape::spread);
  EXPECT_EQ(correction->frame, Submaps::kMapFrame);
  EXPECT_NEAR(correction->offline_from_online.translation.norm(), 0.005, 1e-6);
}

TEST_F(OfflineTrackerTest, SearchesPlacesWhileItsPlaceIsNotAccepted) {
  note_found(0, view_of_room(2, 8));
  tracker_.search_in_background({mission_.frames[4], mission_.rig}, pose_filter_, mapper_);
  const std::optional<PlaceSearch> search = collect_place();
  ASSERT_TRUE(search && search->found);
  EXPECT_EQ(search->time, mission_.frames[4].time);
  EXPECT_THAT(search->found->camera_from_offline, PoseNear(true_camera_from_world(mission_, 4), 0.02, 0.01));
}

TEST_F(OfflineTrackerTest, SearchesPlacesOncePerSecondWithFewOfflinePoints) {
  note_found(0);
  const PlaceView view = view_of_room(4, 6);
  for (int i = 0; i < 6; ++i) {
    pose_filter_.note({mission_.frames[4], track_of(4), false, true, 0, false, &view}, mission_.rig, mapper_.map());
  }
  ASSERT_TRUE(pose_filter_.place().is_accepted());
  note(4, 70);
  tracker_.search_in_background({mission_.frames[4], mission_.rig}, pose_filter_, mapper_);
  const std::optional<PlaceSearch> search = collect_place();
  EXPECT_TRUE(search && search->found);
  tracker_.search_in_background({mission_.frames[5], mission_.rig}, pose_filter_, mapper_);
  EXPECT_FALSE(collect_place());
}

TEST_F(OfflineTrackerTest, SearchesNoPlacesWhileOfflinePointsHoldThePose) {
  note_found(0);
  note(4, 100);
  tracker_.search_in_background({mission_.frames[4], mission_.rig}, pose_filter_, mapper_);
  EXPECT_FALSE(collect_place());
}

// Each frame fits two rooms of the map.
class OfflineTrackerInTwinRooms : public ::testing::Test {
 protected:
  int points_alone(bool finds_rivals) {
    int points = 0;
    const PlaceView view = tracker_.view_of(mission_.frames[0], track_, mission_.rig, {}, finds_rivals);
    for (const CellInView& cell : view.cells) points += cell.expected_alone;
    return points;
  }

  const SimulatedMission mission_ = simulate_mission(simulated_rig(), circling_trajectory(60, 10.0, 2.0, 1.0), {});
  const std::shared_ptr<const OfflineMap> rooms_ = [this] {
    MappedPlace place = twin_rooms(mission_);
    return std::make_shared<const OfflineMap>(std::move(place.map), place.index.vocabulary());
  }();
  Mapper mapper_{mission_.rig, {}, simulated_vocabulary(), rooms_};
  OfflineTracker tracker_{rooms_, {}};
  PoseFilter pose_filter_{{}, {}, {}, true};
  HybridTrack track_ = [this] {
    HybridTrack track;
    track.tracked.camera_from_world = true_camera_from_world(mission_, 0);
    return track;
  }();
};

// One room is 10 m ahead of the other; a third one may be as far behind.
TEST_F(OfflineTrackerInTwinRooms, ALookAlikeBeyondTheMapIsARival) {
  EXPECT_EQ(tracker_.log_odds_of_rivals(), kNoRivals);
  points_alone(true);
  EXPECT_GT(tracker_.log_odds_of_rivals(), 1.9);
}

// From a place without keyframes nearby no look-alikes are found.
TEST_F(OfflineTrackerInTwinRooms, ALookAlikeIsKeptUntilAPlaceIsCertain) {
  const Pose seen = track_.tracked.camera_from_world;
  track_.tracked.camera_from_world = seen * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 5.0}};
  points_alone(true);
  ASSERT_EQ(tracker_.log_odds_of_rivals(), kNoRivals);
  track_.tracked.camera_from_world = seen;
  points_alone(true);
  track_.tracked.camera_from_world = seen * Pose{Eigen::Quaterniond::Identity(), {0.0, 0.0, 5.0}};
  points_alone(true);
  EXPECT_GT(tracker_.log_odds_of_rivals(), 1.9);
}

TEST_F(OfflineTrackerInTwinRooms, CommonPointsAreNoEvidenceAgainstARival) {
  EXPECT_EQ(points_alone(true), 0) << "a third room may look alike beyond the map";
  tracker_.begin_place(mission_.frames[0].time, track_.tracked.camera_from_world);
  HybridTrack elsewhere = track_;
  elsewhere.tracked.camera_from_world =
      track_.tracked.camera_from_world * Pose{Eigen::Quaterniond::Identity(), {-10.0, 0.0, 0.0}};
  tracker_.test_rivals({mission_.frames[0], track_, mission_.rig, 0.0, false, {}, {}}, std::span(&elsewhere, 1),
                       pose_filter_, mapper_);
  EXPECT_EQ(points_alone(true), 0);
  EXPECT_GT(points_alone(false), 0) << "an accepted place is tested by all of its points";
}

}  // namespace
}  // namespace byre
