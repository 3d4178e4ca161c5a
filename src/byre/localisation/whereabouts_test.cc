#include "byre/localisation/whereabouts.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/body_pose.h"
#include "byre/slam/mission_scene.h"
#include "byre/slam/place_view_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// Frames tracked at their true poses, on a true map in which every fourth frame is a keyframe.
class WhereaboutsOnATrueMap : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = simulate_mission(simulated_rig(), circling_trajectory(40, 10.0, 2.0, 0.3), {});
  Map map_ = true_map(mission_, 4, Origin::online);
  Whereabouts whereabouts_{{}, {}, {}, true};
  const PlaceView view_ = view_of_room(10, 0);

  HybridTrack track_of(std::size_t frame) const {
    HybridTrack track;
    track.tracked.camera_from_world = true_camera_from_world(mission_, frame);
    track.tracked.reference = map_.keyframe_ids()[frame / 4];
    track.offline_expected = 100;
    track.offline_inliers = 50;
    return track;
  }
  Whereabouts::Progress note(std::size_t frame, bool from_nothing = false) {
    whereabouts_.tell({});
    return whereabouts_.note({mission_.frames[frame], track_of(frame), from_nothing, true, 0, false, &view_},
                             mission_.rig, map_);
  }
  // Finds the pose at a frame without a prediction, then tracks until it is believed.
  void find_and_believe(std::size_t frame) {
    note(frame, true);
    while (!whereabouts_.place().is_believed()) note(++frame);
  }
  const PlaceHypothesis& place() const { return whereabouts_.place(); }
};

TEST_F(WhereaboutsOnATrueMap, ConfirmAPoseAfterTheConfiguredFrames) {
  EXPECT_FALSE(whereabouts_.has_pose());
  note(0, true);
  EXPECT_TRUE(whereabouts_.has_pose());
  const int frames = RegistrationOptions{}.confirmations;
  for (int i = 1; i <= frames; ++i) {
    EXPECT_FALSE(whereabouts_.last_believed());
    EXPECT_FALSE(note(static_cast<std::size_t>(i)).was_ever_believed);
  }
  EXPECT_EQ(whereabouts_.last_believed(), mission_.frames[static_cast<std::size_t>(frames)].time);
  EXPECT_TRUE(note(static_cast<std::size_t>(frames) + 1).was_ever_believed);
}

TEST_F(WhereaboutsOnATrueMap, DropAPoseThatIsLostBeforeConfirmation) {
  note(0, true);
  note(1);
  whereabouts_.lose();
  EXPECT_FALSE(whereabouts_.has_pose());
  EXPECT_TRUE(whereabouts_.trajectory().empty());
}

TEST_F(WhereaboutsOnATrueMap, KeepOdometryContinuousAfterADroppedPose) {
  note(0, true);
  note(1);
  const Pose smooth = whereabouts_.odometry().odometry_from_body();
  whereabouts_.lose();
  note(9, true);
  EXPECT_THAT(whereabouts_.odometry().odometry_from_body(), PoseNear(smooth, 1e-12, 1e-12));
}

TEST_F(WhereaboutsOnATrueMap, KeepConfirmedFramesWhenThePoseIsLost) {
  find_and_believe(0);
  const std::size_t frames = whereabouts_.trajectory().size();
  whereabouts_.lose();
  EXPECT_EQ(whereabouts_.trajectory().size(), frames);
}

TEST_F(WhereaboutsOnATrueMap, NeedNoNewEvidenceShortlyAfterAnAcceptedPose) {
  find_and_believe(0);
  whereabouts_.lose();
  note(6, true);
  EXPECT_FALSE(place().is_believed());
  EXPECT_TRUE(place().is_accepted());
}

TEST_F(WhereaboutsOnATrueMap, PredictConstantVelocity) {
  find_and_believe(0);
  const std::size_t last = whereabouts_.trajectory().size() - 1;
  whereabouts_.tell({});
  const Pose predicted =
      whereabouts_.motion().predict(true_camera_from_world(mission_, last), mission_.rig,
                                    to_seconds(mission_.frames[last + 1].time - mission_.frames[last].time));
  EXPECT_THAT(predicted, PoseNear(true_camera_from_world(mission_, last + 1), 0.01, 0.01));
}

TEST_F(WhereaboutsOnATrueMap, ExcludeRelocalisationsFromThePathLength) {
  EXPECT_EQ(note(0, true).step, 0.0);
  const double step = note(1).step;
  EXPECT_NEAR(step,
              (mission_.truth[1].world_from_body.translation - mission_.truth[0].world_from_body.translation).norm(),
              1e-9);
  whereabouts_.lose();
  EXPECT_EQ(note(9, true).step, 0.0);
  EXPECT_NEAR(whereabouts_.odometry().travelled(), step, 1e-12);
}

TEST_F(WhereaboutsOnATrueMap, FollowMapCorrections) {
  find_and_believe(0);
  const Pose before = whereabouts_.odometry().map_from_body();
  const Pose smooth = whereabouts_.odometry().odometry_from_body();
  const Pose after_from_before{Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.0}};
  for (const KeyframeId id : map_.keyframe_ids()) {
    map_.move_keyframe(id, map_.camera_from_world(id) * inverse(after_from_before), Matrix6::Identity());
  }
  const auto correction = whereabouts_.follow_map(mission_.rig, map_);
  ASSERT_TRUE(correction);
  EXPECT_THAT(*correction, PoseNear(after_from_before, 1e-9, 1e-9));
  EXPECT_THAT(whereabouts_.odometry().map_from_body(), PoseNear(after_from_before * before, 1e-9, 1e-9));
  EXPECT_THAT(whereabouts_.odometry().odometry_from_body(), PoseNear(smooth, 1e-9, 1e-9));
}

TEST_F(WhereaboutsOnATrueMap, AllowPropagationWhileTheMotionIsCertain) {
  find_and_believe(0);
  whereabouts_.tell(Pose{});
  EXPECT_FALSE(whereabouts_.may_be_led_back()) << "the pose is not lost";
  whereabouts_.lose();
  EXPECT_TRUE(whereabouts_.may_be_led_back());
  Pose far;
  far.translation.x() = 100.0;
  whereabouts_.tell(far);
  EXPECT_FALSE(whereabouts_.may_be_led_back()) << "the covariance after a hundred metres is too large";
}

TEST_F(WhereaboutsOnATrueMap, RejectAPoseBeyondTheReachOfWheels) {
  Whereabouts mapping({}, {}, {}, false);
  const auto is_out_of_reach = [&](std::size_t frame, Timestamp later = {}) {
    Frame seen = mission_.frames[frame];
    seen.time += later;
    return mapping.is_out_of_reach(seen, track_of(frame), mission_.rig, map_);
  };
  mapping.note({mission_.frames[0], track_of(0), true, true, 0}, mission_.rig, map_);
  EXPECT_FALSE(is_out_of_reach(39)) << "no measured motion";
  mapping.hear([](Timestamp, Timestamp) { return std::optional(0.5); });
  EXPECT_FALSE(is_out_of_reach(1));
  EXPECT_TRUE(is_out_of_reach(39));
  EXPECT_FALSE(is_out_of_reach(39, std::chrono::seconds(60))) << "it may have been kidnapped";
  mapping.lose();
  EXPECT_TRUE(is_out_of_reach(39));
}

TEST_F(WhereaboutsOnATrueMap, RejectAPoseThatContradictsWheels) {
  Whereabouts mapping({}, {}, {}, false);
  mapping.hear([](Timestamp, Timestamp) { return std::optional(100.0); });
  mapping.note({mission_.frames[0], track_of(0), true, true, 0}, mission_.rig, map_);
  const auto motion_to = [&](std::size_t frame) {
    return inverse(mission_.truth[0].world_from_body) * mission_.truth[frame].world_from_body;
  };
  const auto is_out_of_reach = [&](std::size_t frame) {
    return mapping.is_out_of_reach(mission_.frames[frame], track_of(frame), mission_.rig, map_);
  };
  mapping.tell(motion_to(20));
  EXPECT_FALSE(is_out_of_reach(20));
  EXPECT_FALSE(is_out_of_reach(21)) << "wheels may err";
  EXPECT_TRUE(is_out_of_reach(39)) << "contradicts the measured motion";
  Pose turned = motion_to(20);
  turned.rotation = turned.rotation * rotation_exp({0.0, 0.0, 2.0});
  mapping.tell(turned);
  EXPECT_TRUE(is_out_of_reach(20)) << "contradicts the measured rotation";
  BodyMotion unsure = motion_to(0);
  unsure.covariance = 100.0 * Matrix6::Identity();
  mapping.tell(unsure);
  EXPECT_FALSE(is_out_of_reach(39)) << "the covariance of the measured motion is too large";
}

// A find that contradicts measured motion after a trusted pose.
TEST_F(WhereaboutsOnATrueMap, RejectAPoseThatContradictsWheelsAfterATrustedPose) {
  whereabouts_.hear([](Timestamp, Timestamp) { return std::optional(100.0); });
  find_and_believe(0);
  const std::size_t here = whereabouts_.trajectory().size() - 1;
  const auto is_out_of_reach = [&](std::size_t frame, Timestamp later = {}) {
    Frame seen = mission_.frames[here];
    seen.time += later;
    return whereabouts_.is_out_of_reach(seen, track_of(frame), mission_.rig, map_);
  };
  EXPECT_TRUE(is_out_of_reach(39)) << "too far for the robot's speed, even without measured motion";
  whereabouts_.tell(Pose{});
  EXPECT_FALSE(is_out_of_reach(39, std::chrono::seconds(60))) << "the last pose was not trusted";
  whereabouts_.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
  EXPECT_TRUE(is_out_of_reach(39));
  EXPECT_FALSE(is_out_of_reach(here));
  EXPECT_TRUE(is_out_of_reach(39, std::chrono::seconds(60)));
  whereabouts_.lose();
  whereabouts_.note({mission_.frames[39], track_of(39), true, true, 0}, mission_.rig, map_);
  whereabouts_.tell(Pose{});
  ASSERT_FALSE(place().is_believed());
  EXPECT_TRUE(is_out_of_reach(39)) << "an unconfirmed pose is no evidence";
  EXPECT_FALSE(is_out_of_reach(here));
  BodyMotion far = Pose{};
  far.covariance = 100.0 * Matrix6::Identity();
  whereabouts_.tell(far);
  EXPECT_FALSE(is_out_of_reach(39, std::chrono::seconds(60))) << "the covariance of the measured motion is too large";
}

TEST_F(WhereaboutsOnATrueMap, PropagateMeasuredMotionUntilItEnds) {
  find_and_believe(0);
  const std::size_t next = whereabouts_.trajectory().size();
  const Pose before = whereabouts_.odometry().map_from_body();
  Pose ahead;
  ahead.translation.x() = 0.1;
  for (std::size_t i = 0; i < 3; ++i) {
    whereabouts_.tell(ahead);
    whereabouts_.lose();
    EXPECT_TRUE(whereabouts_.go_on(mission_.frames[next + i].time, mission_.rig, map_));
  }
  EXPECT_THAT(whereabouts_.bridge()->last_from_body, PoseNear(ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_THAT(whereabouts_.odometry().map_from_body(), PoseNear(before * ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_EQ(whereabouts_.trajectory().size(), next + 3);
  whereabouts_.tell({});
  whereabouts_.lose();
  EXPECT_FALSE(whereabouts_.go_on(mission_.frames[next + 3].time, mission_.rig, map_));
  EXPECT_FALSE(whereabouts_.bridge());
}

// A find that is lost before it is believed does not end the bridge before it.
TEST_F(WhereaboutsOnATrueMap, PropagateFromTheLastConfirmedPoseAfterAFalseOne) {
  find_and_believe(0);
  const std::size_t next = whereabouts_.trajectory().size();
  const Pose before = whereabouts_.odometry().map_from_body();
  const Pose smooth = whereabouts_.odometry().odometry_from_body();
  Pose ahead;
  ahead.translation.x() = 0.1;
  whereabouts_.tell(ahead);
  whereabouts_.lose();
  whereabouts_.go_on(mission_.frames[next].time, mission_.rig, map_);
  whereabouts_.tell(ahead);
  whereabouts_.note({mission_.frames[next + 1], track_of(0), true, true, 0}, mission_.rig, map_);
  whereabouts_.tell(ahead);
  whereabouts_.lose();
  ASSERT_TRUE(whereabouts_.go_on(mission_.frames[next + 2].time, mission_.rig, map_));
  EXPECT_THAT(whereabouts_.odometry().map_from_body(), PoseNear(before * ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_THAT(whereabouts_.odometry().odometry_from_body(), PoseNear(smooth * ahead * ahead * ahead, 1e-9, 1e-9))
      << "odometry is independent of the map pose";
}

TEST_F(WhereaboutsOnATrueMap, PredictTheRegistrationOfASubmapByTheBridge) {
  Pose far;
  far.translation.x() = 20.0;
  const auto begin_after = [&](std::size_t bridged_frames) {
    Whereabouts whereabouts({}, {}, {}, true);
    for (std::size_t i = 0; !whereabouts.place().is_believed() || i == 0; ++i) {
      whereabouts.tell({});
      whereabouts.note({mission_.frames[i], track_of(i), i == 0, true, 0, false, &view_}, mission_.rig, map_);
    }
    whereabouts.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
    for (std::size_t i = 0; i < bridged_frames; ++i) {
      whereabouts.tell(Pose{});
      whereabouts.lose();
      EXPECT_TRUE(whereabouts.go_on(mission_.frames[4 + i].time, mission_.rig, map_));
    }
    whereabouts.begin({map_.keyframe_ids()[2]}, 1, mission_.rig, map_);
    return whereabouts;
  };
  EXPECT_EQ(begin_after(0).log_odds_of_registration(far), 0.0) << "no bridge predicts its start";
  Whereabouts bridged = begin_after(3);
  EXPECT_EQ(bridged.log_odds_of_registration(Pose{}), 0.0);
  EXPECT_EQ(bridged.log_odds_of_registration(far), kLogOddsOfCarried);
  Whereabouts hinted = bridged;
  hinted.note_registration(far, true);
  EXPECT_EQ(hinted.place().log_odds(), 0.0) << "a hint outweighs the bridge";
  bridged.note_registration(far, false);
  bridged.tell({});
  bridged.note({mission_.frames[12], track_of(12), false, true, 1, false, &view_}, mission_.rig, map_);
  hinted.tell({});
  hinted.note({mission_.frames[12], track_of(12), false, true, 1, false, &view_}, mission_.rig, map_);
  EXPECT_NEAR(bridged.place().log_odds(), hinted.place().log_odds() + kLogOddsOfCarried, 1e-9);
}

TEST_F(WhereaboutsOnATrueMap, MeasureTheReachFromTheLastConfirmedPose) {
  whereabouts_ = Whereabouts({.max_speed = 0.5}, {}, {}, true);
  find_and_believe(0);
  ASSERT_TRUE(place().is_accepted());
  const std::size_t next = whereabouts_.trajectory().size();
  const auto find_elsewhere = [&](double seconds_later) {
    Frame seen = mission_.frames[next];
    seen.time += from_seconds(seconds_later);
    whereabouts_.lose();
    whereabouts_.tell({});
    whereabouts_.note({seen, track_of(39), true, true, 0}, mission_.rig, map_);
  };
  find_elsewhere(0.0);
  EXPECT_EQ(place().log_odds(), kLogOddsOfCarried);
  find_elsewhere(1.5);
  EXPECT_EQ(place().log_odds(), kLogOddsOfCarried) << "near an unconfirmed pose";
}

TEST_F(WhereaboutsOnATrueMap, PenaliseAPoseManySigmasFromMeasuredMotion) {
  whereabouts_.hear([](Timestamp, Timestamp) { return std::optional(100.0); });
  find_and_believe(0);
  whereabouts_.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
  const std::size_t here = whereabouts_.trajectory().size() - 1;
  const auto log_odds_of_find = [&](std::size_t frame, bool is_measured) {
    Whereabouts whereabouts = whereabouts_;
    whereabouts.lose();
    BodyMotion standing = Pose{};
    standing.covariance = 0.01 * Matrix6::Identity();
    whereabouts.tell(is_measured ? std::optional(standing) : std::nullopt);
    Frame seen = mission_.frames[here];
    seen.time += from_seconds(2.0);  // enough time to drive there
    whereabouts.note({seen, track_of(frame), true, true, 0}, mission_.rig, map_);
    return whereabouts.place().log_odds();
  };
  EXPECT_EQ(log_odds_of_find(39, true), kLogOddsOfCarried);
  EXPECT_EQ(log_odds_of_find(39, false), 0.0);
  EXPECT_EQ(log_odds_of_find(here, true), 0.0);
}

TEST_F(WhereaboutsOnATrueMap, TestAPlaceAgainAfterARefutation) {
  find_and_believe(0);
  ASSERT_TRUE(place().is_accepted());
  const std::size_t next = whereabouts_.trajectory().size();
  Whereabouts lost = whereabouts_;
  lost.lose();
  lost.tell({});
  lost.note({mission_.frames[next], track_of(next), true, true, 0}, mission_.rig, map_);
  EXPECT_TRUE(lost.place().is_accepted()) << "shortly lost, the place stays accepted";
  whereabouts_.give_up();
  whereabouts_.tell({});
  whereabouts_.note({mission_.frames[next], track_of(next), true, true, 0}, mission_.rig, map_);
  EXPECT_FALSE(place().is_accepted());
}

TEST_F(WhereaboutsOnATrueMap, ConfirmASubmapAtItsStart) {
  whereabouts_.begin({map_.keyframe_ids().front()}, 0, mission_.rig, map_);
  EXPECT_TRUE(whereabouts_.has_pose());
  EXPECT_TRUE(place().is_believed());
  EXPECT_THAT(whereabouts_.odometry().odometry_from_body(), PoseNear(Pose{}, 1e-12, 1e-12));
  whereabouts_.lose();
  EXPECT_EQ(whereabouts_.trajectory().size(), 1u);
}

}  // namespace
}  // namespace byre
