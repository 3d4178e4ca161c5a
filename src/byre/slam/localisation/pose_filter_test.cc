#include "byre/slam/localisation/pose_filter.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/places/place_view_scene.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/mission_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

// Frames tracked at their true poses, on a true map in which every fourth frame is a keyframe.
class WhereaboutsOnATrueMap : public ::testing::Test {
 protected:
  const SimulatedMission mission_ = simulate_mission(simulated_rig(), circling_trajectory(40, 10.0, 2.0, 0.3), {});
  MapGraph map_ = true_map(mission_, 4, Origin::online);
  PoseFilter pose_filter_{{}, {}, {}, true};
  const PlaceView view_ = view_of_room(10, 0);

  HybridTrack track_of(std::size_t frame) const {
    HybridTrack track;
    track.tracked.camera_from_world = true_camera_from_world(mission_, frame);
    track.tracked.reference = map_.keyframe_ids()[frame / 4];
    track.offline_expected = 100;
    track.offline_inliers = 50;
    return track;
  }
  PoseFilter::Progress note(std::size_t frame, bool is_relocalised = false) {
    pose_filter_.add_odometry({});
    return pose_filter_.note({mission_.frames[frame], track_of(frame), is_relocalised, true, 0, false, &view_},
                             mission_.rig, map_);
  }
  // Finds the pose at a frame without a prediction, then tracks until it is confirmed.
  void find_and_confirm(std::size_t frame) {
    note(frame, true);
    while (!pose_filter_.place().is_confirmed()) note(++frame);
  }
  const PlaceHypothesis& place() const { return pose_filter_.place(); }
};

TEST_F(WhereaboutsOnATrueMap, ConfirmAPoseAfterTheConfiguredFrames) {
  EXPECT_FALSE(pose_filter_.has_pose());
  note(0, true);
  EXPECT_TRUE(pose_filter_.has_pose());
  const int frames = RegistrationOptions{}.confirmations;
  for (int i = 1; i <= frames; ++i) {
    EXPECT_FALSE(pose_filter_.last_confirmed());
    EXPECT_FALSE(note(static_cast<std::size_t>(i)).was_ever_confirmed);
  }
  EXPECT_EQ(pose_filter_.last_confirmed(), mission_.frames[static_cast<std::size_t>(frames)].time);
  EXPECT_TRUE(note(static_cast<std::size_t>(frames) + 1).was_ever_confirmed);
}

TEST_F(WhereaboutsOnATrueMap, DropAPoseThatIsLostBeforeConfirmation) {
  note(0, true);
  note(1);
  pose_filter_.mark_lost();
  EXPECT_FALSE(pose_filter_.has_pose());
  EXPECT_TRUE(pose_filter_.trajectory().empty());
}

TEST_F(WhereaboutsOnATrueMap, KeepOdometryContinuousAfterADroppedPose) {
  note(0, true);
  note(1);
  const Pose smooth = pose_filter_.odometry().odometry_from_body();
  pose_filter_.mark_lost();
  note(9, true);
  EXPECT_THAT(pose_filter_.odometry().odometry_from_body(), PoseNear(smooth, 1e-12, 1e-12));
}

TEST_F(WhereaboutsOnATrueMap, KeepConfirmedFramesWhenThePoseIsLost) {
  find_and_confirm(0);
  const std::size_t frames = pose_filter_.trajectory().size();
  pose_filter_.mark_lost();
  EXPECT_EQ(pose_filter_.trajectory().size(), frames);
}

TEST_F(WhereaboutsOnATrueMap, NeedNoNewEvidenceShortlyAfterAnAcceptedPose) {
  find_and_confirm(0);
  pose_filter_.mark_lost();
  note(6, true);
  EXPECT_FALSE(place().is_confirmed());
  EXPECT_TRUE(place().is_accepted());
}

TEST_F(WhereaboutsOnATrueMap, PredictConstantVelocity) {
  find_and_confirm(0);
  const std::size_t last = pose_filter_.trajectory().size() - 1;
  pose_filter_.add_odometry({});
  const Pose predicted =
      pose_filter_.motion().predict(true_camera_from_world(mission_, last), mission_.rig,
                                    to_seconds(mission_.frames[last + 1].time - mission_.frames[last].time));
  EXPECT_THAT(predicted, PoseNear(true_camera_from_world(mission_, last + 1), 0.01, 0.01));
}

TEST_F(WhereaboutsOnATrueMap, ReportAnUnexplainedJumpInTheCovariance) {
  find_and_confirm(0);
  const auto last = [&] { return pose_filter_.trajectory().size() - 1; };
  const auto sigma = [&] { return std::sqrt(pose_filter_.jump_covariance().topLeftCorner<3, 3>().trace()); };
  note(last() + 1);
  EXPECT_EQ(sigma(), 0.0);

  const std::size_t frame = last() + 1;
  HybridTrack elsewhere = track_of(frame);
  const Pose jump{Eigen::Quaterniond::Identity(), {0.5, 0.0, 0.0}};
  elsewhere.tracked.camera_from_world = elsewhere.tracked.camera_from_world * jump;
  const auto note_elsewhere = [&](double drift, const std::optional<BodyMotion>& motion) {
    PoseFilter filter = pose_filter_;
    filter.add_odometry(motion);
    filter.note({mission_.frames[frame], elsewhere, false, true, 0, false, &view_, nullptr, kNoRivals, drift},
                mission_.rig, map_);
    return std::sqrt(filter.jump_covariance().topLeftCorner<3, 3>().trace());
  };
  const Pose body = body_pose(mission_.rig, true_camera_from_world(mission_, frame - 1));
  const Pose body_elsewhere = body_pose(mission_.rig, elsewhere.tracked.camera_from_world);
  EXPECT_EQ(note_elsewhere(0.2, {}), 0.0) << "drift without offline points explains it";
  EXPECT_EQ(note_elsewhere(0.0, inverse(body) * body_elsewhere), 0.0) << "wheels explain it";
  EXPECT_NEAR(note_elsewhere(0.0, {}), 0.5, 0.1);
}

TEST_F(WhereaboutsOnATrueMap, KeepADisagreementOfTheMapsInTheCovarianceUntilOfflinePointsHold) {
  find_and_confirm(0);
  const auto sigma_after = [&](bool maps_disagree, int offline_inliers) {
    const std::size_t frame = pose_filter_.trajectory().size();
    HybridTrack track = track_of(frame);
    track.maps_disagree = maps_disagree;
    track.offline_inliers = offline_inliers;
    track.from_offline = track.from_online = track.tracked.camera_from_world;
    track.from_offline->translation.x() += 0.15;
    pose_filter_.add_odometry({});
    pose_filter_.note({mission_.frames[frame], track, false, true, 0, false, &view_}, mission_.rig, map_);
    return std::sqrt(pose_filter_.jump_covariance().topLeftCorner<3, 3>().trace());
  };
  EXPECT_EQ(sigma_after(false, 100), 0.0);
  EXPECT_NEAR(sigma_after(true, 20), 0.15, 1e-9);
  EXPECT_NEAR(sigma_after(false, 0), 0.15, 1e-9);
  EXPECT_NEAR(sigma_after(false, 10), 0.15, 1e-9) << "too few points";
  EXPECT_EQ(sigma_after(false, 100), 0.0);
}

TEST_F(WhereaboutsOnATrueMap, DoubtAnOfflinePoseThatPrevailsAgainstAPreciseOnlineMap) {
  find_and_confirm(0);
  const auto sigma_with = [&](double online_sigma) {
    const std::size_t frame = pose_filter_.trajectory().size();
    HybridTrack track = track_of(frame);
    track.maps_disagree = track.offline_prevails = true;
    track.offline_inliers = 100;
    track.offline_sigma = 0.01;
    track.online_sigma = online_sigma;
    track.from_offline = track.from_online = track.tracked.camera_from_world;
    track.from_offline->translation.x() += 0.15;
    pose_filter_.add_odometry({});
    pose_filter_.note({mission_.frames[frame], track, false, true, 0, false, &view_}, mission_.rig, map_);
    return std::sqrt(pose_filter_.jump_covariance().topLeftCorner<3, 3>().trace());
  };
  EXPECT_NEAR(sigma_with(0.01), 0.15, 1e-9);
  EXPECT_EQ(sigma_with(0.1), 0.0) << "drift explains it";
}

TEST_F(WhereaboutsOnATrueMap, AddTheErrorOfLengthsSinceOfflinePointsHeldToTheCovariance) {
  constexpr double kShare = 0.02;
  find_and_confirm(0);
  const auto drift = [&] { return pose_filter_.drift_covariance(kShare); };
  EXPECT_EQ(drift().norm(), 0.0) << "no offline point held the pose yet";
  EXPECT_EQ(pose_filter_.drift_sigma(kShare), std::numeric_limits<double>::infinity());
  pose_filter_.note_held(0.0, kShare);
  EXPECT_EQ(drift().norm(), 0.0);
  const Eigen::Vector3d held = pose_filter_.odometry().map_from_body().translation;
  const std::size_t first = pose_filter_.trajectory().size();
  for (std::size_t i = first; i < first + 10; ++i) note(i);
  const Pose& body = pose_filter_.odometry().map_from_body();
  const Eigen::Vector3d error = kShare * (body.rotation.conjugate() * (body.translation - held));
  EXPECT_GT(error.norm(), 0.01);
  const double along_way = error.normalized().dot(drift().topLeftCorner<3, 3>() * error.normalized());
  EXPECT_NEAR(std::sqrt(along_way), error.norm(), 0.1 * error.norm());
  EXPECT_NEAR(pose_filter_.drift_sigma(kShare), error.norm(), 0.1 * error.norm()) << "mostly along the way";
  const Matrix6 before = drift();
  pose_filter_.note_held(2.0 * error.norm(), kShare);
  EXPECT_EQ(drift(), before) << "less precise than the drift";
  pose_filter_.note_held(0.5 * error.norm(), kShare);
  EXPECT_NEAR(pose_filter_.drift_sigma(kShare), 0.5 * error.norm(), 1e-9);
}

TEST_F(WhereaboutsOnATrueMap, ForgetAJumpAfterConsistentMotion) {
  find_and_confirm(0);
  const std::size_t frame = pose_filter_.trajectory().size();
  HybridTrack elsewhere = track_of(frame);
  elsewhere.tracked.camera_from_world.translation.x() += 0.5;
  pose_filter_.add_odometry({});
  pose_filter_.note({mission_.frames[frame], elsewhere, false, true, 0, false, &view_}, mission_.rig, map_);
  const double jumped = pose_filter_.jump_covariance().trace();
  for (std::size_t later = frame + 1; later < 40; ++later) note(later);
  EXPECT_LT(pose_filter_.jump_covariance().trace(), 0.2 * jumped);
}

TEST_F(WhereaboutsOnATrueMap, ExcludeRelocalisationsFromThePathLength) {
  EXPECT_EQ(note(0, true).step, 0.0);
  const double step = note(1).step;
  EXPECT_NEAR(step,
              (mission_.truth[1].world_from_body.translation - mission_.truth[0].world_from_body.translation).norm(),
              1e-9);
  pose_filter_.mark_lost();
  EXPECT_EQ(note(9, true).step, 0.0);
  EXPECT_NEAR(pose_filter_.odometry().travelled(), step, 1e-12);
}

TEST_F(WhereaboutsOnATrueMap, FollowMapCorrections) {
  find_and_confirm(0);
  const Pose before = pose_filter_.odometry().map_from_body();
  const Pose smooth = pose_filter_.odometry().odometry_from_body();
  const Pose after_from_before{Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.0}};
  for (const KeyframeId id : map_.keyframe_ids()) {
    map_.move_keyframe(id, map_.camera_from_world(id) * inverse(after_from_before), Matrix6::Identity());
  }
  const auto correction = pose_filter_.apply_map_correction(mission_.rig, map_);
  ASSERT_TRUE(correction);
  EXPECT_THAT(*correction, PoseNear(after_from_before, 1e-9, 1e-9));
  EXPECT_THAT(pose_filter_.odometry().map_from_body(), PoseNear(after_from_before * before, 1e-9, 1e-9));
  EXPECT_THAT(pose_filter_.odometry().odometry_from_body(), PoseNear(smooth, 1e-9, 1e-9));
}

TEST_F(WhereaboutsOnATrueMap, AllowPropagationWhileTheMotionIsCertain) {
  find_and_confirm(0);
  pose_filter_.add_odometry(Pose{});
  EXPECT_FALSE(pose_filter_.can_return_by_odometry()) << "the pose is not lost";
  pose_filter_.mark_lost();
  EXPECT_TRUE(pose_filter_.can_return_by_odometry());
  Pose far;
  far.translation.x() = 100.0;
  pose_filter_.add_odometry(far);
  EXPECT_FALSE(pose_filter_.can_return_by_odometry()) << "the covariance after a hundred metres is too large";
}

TEST_F(WhereaboutsOnATrueMap, RejectAPoseBeyondTheReachOfWheels) {
  PoseFilter mapping({}, {}, {}, false);
  const auto is_unreachable = [&](std::size_t frame, Timestamp later = {}) {
    Frame seen = mission_.frames[frame];
    seen.time += later;
    return mapping.is_unreachable(seen, track_of(frame), mission_.rig, map_);
  };
  mapping.note({mission_.frames[0], track_of(0), true, true, 0}, mission_.rig, map_);
  EXPECT_FALSE(is_unreachable(39)) << "no measured motion";
  mapping.set_odometry([](Timestamp, Timestamp) { return std::optional(0.5); });
  EXPECT_FALSE(is_unreachable(1));
  EXPECT_TRUE(is_unreachable(39));
  EXPECT_FALSE(is_unreachable(39, std::chrono::seconds(60))) << "it may have been kidnapped";
  mapping.mark_lost();
  EXPECT_TRUE(is_unreachable(39));
}

TEST_F(WhereaboutsOnATrueMap, RejectAPoseThatContradictsWheels) {
  PoseFilter mapping({}, {}, {}, false);
  mapping.set_odometry([](Timestamp, Timestamp) { return std::optional(100.0); });
  mapping.note({mission_.frames[0], track_of(0), true, true, 0}, mission_.rig, map_);
  const auto motion_to = [&](std::size_t frame) {
    return inverse(mission_.truth[0].world_from_body) * mission_.truth[frame].world_from_body;
  };
  const auto is_unreachable = [&](std::size_t frame) {
    return mapping.is_unreachable(mission_.frames[frame], track_of(frame), mission_.rig, map_);
  };
  mapping.add_odometry(motion_to(20));
  EXPECT_FALSE(is_unreachable(20));
  EXPECT_FALSE(is_unreachable(21)) << "wheels may err";
  EXPECT_TRUE(is_unreachable(39)) << "contradicts the measured motion";
  Pose turned = motion_to(20);
  turned.rotation = turned.rotation * rotation_exp({0.0, 0.0, 2.0});
  mapping.add_odometry(turned);
  EXPECT_TRUE(is_unreachable(20)) << "contradicts the measured rotation";
  BodyMotion unsure = motion_to(0);
  unsure.covariance = 100.0 * Matrix6::Identity();
  mapping.add_odometry(unsure);
  EXPECT_FALSE(is_unreachable(39)) << "the covariance of the measured motion is too large";
}

// A find that contradicts measured motion after a trusted pose.
TEST_F(WhereaboutsOnATrueMap, CompareAPoseWithMeasuredMotionInTheDirectionOfTheirDifference) {
  const auto is_unreachable = [&](const Eigen::Vector3d& turn_variances) {
    PoseFilter mapping({}, {}, {}, false);
    mapping.set_odometry([](Timestamp, Timestamp) { return std::optional(100.0); });
    mapping.note({mission_.frames[0], track_of(0), true, true, 0}, mission_.rig, map_);
    BodyMotion turned = inverse(mission_.truth[0].world_from_body) * mission_.truth[20].world_from_body;
    turned.last_from_body.rotation = turned.last_from_body.rotation * rotation_exp({0.0, 0.0, 2.0});
    turned.covariance.bottomRightCorner<3, 3>() = turn_variances.asDiagonal();
    mapping.add_odometry(turned);
    return mapping.is_unreachable(mission_.frames[20], track_of(20), mission_.rig, map_);
  };
  EXPECT_TRUE(is_unreachable({1e-4, 1e-4, 1e-4}));
  EXPECT_TRUE(is_unreachable({1.0, 1.0, 1e-4})) << "the tilt is unknown, the heading is known";
  EXPECT_FALSE(is_unreachable({1e-4, 1e-4, 1.0})) << "the heading is unknown";
}

TEST_F(WhereaboutsOnATrueMap, RejectAPoseThatContradictsWheelsAfterATrustedPose) {
  pose_filter_.set_odometry([](Timestamp, Timestamp) { return std::optional(100.0); });
  find_and_confirm(0);
  const std::size_t here = pose_filter_.trajectory().size() - 1;
  const auto is_unreachable = [&](std::size_t frame, Timestamp later = {}) {
    Frame seen = mission_.frames[here];
    seen.time += later;
    return pose_filter_.is_unreachable(seen, track_of(frame), mission_.rig, map_);
  };
  EXPECT_TRUE(is_unreachable(39)) << "too far for the robot's speed, even without measured motion";
  pose_filter_.add_odometry(Pose{});
  EXPECT_FALSE(is_unreachable(39, std::chrono::seconds(60))) << "the last pose was not trusted";
  pose_filter_.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
  EXPECT_TRUE(is_unreachable(39));
  EXPECT_FALSE(is_unreachable(here));
  EXPECT_TRUE(is_unreachable(39, std::chrono::seconds(60)));
  pose_filter_.mark_lost();
  pose_filter_.note({mission_.frames[39], track_of(39), true, true, 0}, mission_.rig, map_);
  pose_filter_.add_odometry(Pose{});
  ASSERT_FALSE(place().is_confirmed());
  EXPECT_TRUE(is_unreachable(39)) << "an unconfirmed pose is no evidence";
  EXPECT_FALSE(is_unreachable(here));
  BodyMotion far = Pose{};
  far.covariance = 100.0 * Matrix6::Identity();
  pose_filter_.add_odometry(far);
  EXPECT_FALSE(is_unreachable(39, std::chrono::seconds(60))) << "the covariance of the measured motion is too large";
}

TEST_F(WhereaboutsOnATrueMap, PropagateMeasuredMotionUntilItEnds) {
  find_and_confirm(0);
  const std::size_t next = pose_filter_.trajectory().size();
  const Pose before = pose_filter_.odometry().map_from_body();
  Pose ahead;
  ahead.translation.x() = 0.1;
  for (std::size_t i = 0; i < 3; ++i) {
    pose_filter_.add_odometry(ahead);
    pose_filter_.mark_lost();
    EXPECT_TRUE(pose_filter_.propagate(mission_.frames[next + i].time, mission_.rig, map_));
  }
  EXPECT_THAT(pose_filter_.bridge()->last_from_body, PoseNear(ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_THAT(pose_filter_.odometry().map_from_body(), PoseNear(before * ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_EQ(pose_filter_.trajectory().size(), next + 3);
  pose_filter_.add_odometry({});
  pose_filter_.mark_lost();
  EXPECT_FALSE(pose_filter_.propagate(mission_.frames[next + 3].time, mission_.rig, map_));
  EXPECT_FALSE(pose_filter_.bridge());
}

// A find that is lost before it is confirmed does not end the bridge before it.
TEST_F(WhereaboutsOnATrueMap, PropagateFromTheLastConfirmedPoseAfterAFalseOne) {
  find_and_confirm(0);
  const std::size_t next = pose_filter_.trajectory().size();
  const Pose before = pose_filter_.odometry().map_from_body();
  const Pose smooth = pose_filter_.odometry().odometry_from_body();
  Pose ahead;
  ahead.translation.x() = 0.1;
  pose_filter_.add_odometry(ahead);
  pose_filter_.mark_lost();
  pose_filter_.propagate(mission_.frames[next].time, mission_.rig, map_);
  pose_filter_.add_odometry(ahead);
  pose_filter_.note({mission_.frames[next + 1], track_of(0), true, true, 0}, mission_.rig, map_);
  pose_filter_.add_odometry(ahead);
  pose_filter_.mark_lost();
  ASSERT_TRUE(pose_filter_.propagate(mission_.frames[next + 2].time, mission_.rig, map_));
  EXPECT_THAT(pose_filter_.odometry().map_from_body(), PoseNear(before * ahead * ahead * ahead, 1e-9, 1e-9));
  EXPECT_THAT(pose_filter_.odometry().odometry_from_body(), PoseNear(smooth * ahead * ahead * ahead, 1e-9, 1e-9))
      << "odometry is independent of the map pose";
}

TEST_F(WhereaboutsOnATrueMap, PredictTheRegistrationOfASubmapByTheBridge) {
  Pose far;
  far.translation.x() = 20.0;
  const auto begin_after = [&](std::size_t bridged_frames) {
    PoseFilter pose_filter({}, {}, {}, true);
    for (std::size_t i = 0; !pose_filter.place().is_confirmed() || i == 0; ++i) {
      pose_filter.add_odometry({});
      pose_filter.note({mission_.frames[i], track_of(i), i == 0, true, 0, false, &view_}, mission_.rig, map_);
    }
    pose_filter.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
    for (std::size_t i = 0; i < bridged_frames; ++i) {
      pose_filter.add_odometry(Pose{});
      pose_filter.mark_lost();
      EXPECT_TRUE(pose_filter.propagate(mission_.frames[4 + i].time, mission_.rig, map_));
    }
    pose_filter.begin({map_.keyframe_ids()[2]}, 1, mission_.rig, map_);
    return pose_filter;
  };
  EXPECT_EQ(begin_after(0).log_odds_of_registration(far), 0.0) << "no bridge predicts its start";
  PoseFilter bridged = begin_after(3);
  EXPECT_EQ(bridged.log_odds_of_registration(Pose{}), 0.0);
  EXPECT_EQ(bridged.log_odds_of_registration(far), kLogOddsOfKidnapping);
  PoseFilter hinted = bridged;
  hinted.note_registration(far, true);
  EXPECT_EQ(hinted.place().log_odds(), 0.0) << "a hint outweighs the bridge";
  bridged.note_registration(far, false);
  bridged.add_odometry({});
  bridged.note({mission_.frames[12], track_of(12), false, true, 1, false, &view_}, mission_.rig, map_);
  hinted.add_odometry({});
  hinted.note({mission_.frames[12], track_of(12), false, true, 1, false, &view_}, mission_.rig, map_);
  EXPECT_NEAR(bridged.place().log_odds(), hinted.place().log_odds() + kLogOddsOfKidnapping, 1e-9);
}

TEST_F(WhereaboutsOnATrueMap, MeasureTheReachFromTheLastConfirmedPose) {
  pose_filter_ = PoseFilter({.max_speed = 0.5}, {}, {}, true);
  find_and_confirm(0);
  ASSERT_TRUE(place().is_accepted());
  const std::size_t next = pose_filter_.trajectory().size();
  const auto find_elsewhere = [&](double seconds_later) {
    Frame seen = mission_.frames[next];
    seen.time += from_seconds(seconds_later);
    pose_filter_.mark_lost();
    pose_filter_.add_odometry({});
    pose_filter_.note({seen, track_of(39), true, true, 0}, mission_.rig, map_);
  };
  find_elsewhere(0.0);
  EXPECT_EQ(place().log_odds(), kLogOddsOfKidnapping);
  find_elsewhere(1.5);
  EXPECT_EQ(place().log_odds(), kLogOddsOfKidnapping) << "near an unconfirmed pose";
}

TEST_F(WhereaboutsOnATrueMap, PenaliseAPoseManySigmasFromMeasuredMotion) {
  pose_filter_.set_odometry([](Timestamp, Timestamp) { return std::optional(100.0); });
  find_and_confirm(0);
  pose_filter_.note_quality({1e-6 * Matrix6::Identity(), 1e-6 * Matrix6::Identity(), Verdict::trusted});
  const std::size_t here = pose_filter_.trajectory().size() - 1;
  const auto log_odds_of_relocalisation = [&](std::size_t frame, bool is_measured) {
    PoseFilter pose_filter = pose_filter_;
    pose_filter.mark_lost();
    BodyMotion standing = Pose{};
    standing.covariance = 0.01 * Matrix6::Identity();
    pose_filter.add_odometry(is_measured ? std::optional(standing) : std::nullopt);
    Frame seen = mission_.frames[here];
    seen.time += from_seconds(2.0);  // enough time to drive there
    pose_filter.note({seen, track_of(frame), true, true, 0}, mission_.rig, map_);
    return pose_filter.place().log_odds();
  };
  EXPECT_EQ(log_odds_of_relocalisation(39, true), kLogOddsOfKidnapping);
  EXPECT_EQ(log_odds_of_relocalisation(39, false), 0.0);
  EXPECT_EQ(log_odds_of_relocalisation(here, true), 0.0);
}

TEST_F(WhereaboutsOnATrueMap, TestAPlaceAgainAfterARefutation) {
  find_and_confirm(0);
  ASSERT_TRUE(place().is_accepted());
  const std::size_t next = pose_filter_.trajectory().size();
  PoseFilter lost = pose_filter_;
  lost.mark_lost();
  lost.add_odometry({});
  lost.note({mission_.frames[next], track_of(next), true, true, 0}, mission_.rig, map_);
  EXPECT_TRUE(lost.place().is_accepted()) << "shortly lost, the place stays accepted";
  pose_filter_.reset();
  pose_filter_.add_odometry({});
  pose_filter_.note({mission_.frames[next], track_of(next), true, true, 0}, mission_.rig, map_);
  EXPECT_FALSE(place().is_accepted());
}

TEST_F(WhereaboutsOnATrueMap, ConfirmASubmapAtItsStart) {
  pose_filter_.begin({map_.keyframe_ids().front()}, 0, mission_.rig, map_);
  EXPECT_TRUE(pose_filter_.has_pose());
  EXPECT_TRUE(place().is_confirmed());
  EXPECT_THAT(pose_filter_.odometry().odometry_from_body(), PoseNear(Pose{}, 1e-12, 1e-12));
  pose_filter_.mark_lost();
  EXPECT_EQ(pose_filter_.trajectory().size(), 1u);
}

}  // namespace
}  // namespace byre
