// Missions on an offline map: localising in it, leaving it, blinded, kidnapped and lost robots.

#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/session/mission_session_scene.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>

#include <gmock/gmock.h>

namespace byre {
namespace {

Frame frame_of(Timestamp time, std::vector<Keypoint> keypoints, std::vector<Descriptor> descriptors) {
  const Rig rig = simulated_rig();
  return {time, std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints), std::move(descriptors),
                                                 std::vector<Patch>{})};
}

// Frame with a third of its features.
Frame thinned(const Frame& frame) {
  std::vector<Keypoint> keypoints;
  std::vector<Descriptor> descriptors;
  for (int i = 0; i < frame.features->size(); i += 3) {
    keypoints.push_back(frame.features->keypoint(i));
    descriptors.push_back(frame.features->descriptor(i));
  }
  return frame_of(frame.time, std::move(keypoints), std::move(descriptors));
}

// Frame with the features of the left third of the image.
Frame left_third_of(const Frame& frame) {
  return seen_beside(frame, simulated_rig(), [](const Eigen::Vector2f& pixel) { return pixel.x() > 250.0f; });
}

// Features of both frames, as if one place looked like two.
Frame overlaid(const Frame& frame, const Frame& other) {
  std::vector<Keypoint> keypoints = to_vector(frame.features->keypoints());
  std::vector<Descriptor> descriptors = to_vector(frame.features->descriptors());
  std::ranges::copy(other.features->keypoints(), std::back_inserter(keypoints));
  std::ranges::copy(other.features->descriptors(), std::back_inserter(descriptors));
  return frame_of(frame.time, std::move(keypoints), std::move(descriptors));
}

// Frame with the time of another one.
Frame at_time_of(const Frame& frame, const Frame& now) {
  return {now.time, frame.features};
}

// Frame seen through a lens with dirt.
Frame soiled(const Frame& frame) {
  const auto is_behind = [](const Eigen::Vector2f& pixel) {
    const bool is_in_middle = pixel.x() > 250.0f && pixel.x() < 450.0f && pixel.y() > 150.0f && pixel.y() < 330.0f;
    return is_in_middle || (pixel.x() < 180.0f && pixel.y() < 200.0f);
  };
  return seen_beside(frame, simulated_rig(), is_behind);
}

// Largest error of the steps of the odometry, metres.
double worst_step(const std::vector<FrameReport>& reports, const Trajectory& truth) {
  double worst = 0.0;
  for (std::size_t i = 1; i < reports.size(); ++i) {
    if (!reports[i].odometry_from_body || !reports[i - 1].odometry_from_body) continue;
    const Pose step = inverse(*reports[i - 1].odometry_from_body) * *reports[i].odometry_from_body;
    const Pose true_step = inverse(truth[i - 1].world_from_body) * truth[i].world_from_body;
    worst = std::max(worst, (step.translation - true_step.translation).norm());
  }
  return worst;
}

TEST(Mission, LocalisesInTheFirstFrameAndIsTrustedOnceConfirmed) {
  const SimulatedMission mission = laps_of_room(0.5, 2);
  Session session = session_on(mapped(1.0));
  const auto reports = reports_of(session, mission.frames);
  ASSERT_TRUE(reports[0].map_from_body);
  EXPECT_THAT(*reports[0].map_from_body, PoseNear(mission.truth[0].world_from_body, 0.03, 0.3 * kDegree));
  EXPECT_EQ(reports[0].health.verdict, Verdict::untrusted);
  EXPECT_EQ(reports[0].health.doubt, DistrustReason::unconfirmed);
  EXPECT_TRUE(reports[3].has(SessionEvent::localised));
  EXPECT_EQ(count_trusted(reports), static_cast<int>(reports.size()) - 3);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

TEST(Mission, RecordsSightingsByNumberInAMapWithRemovedPoints) {
  MapGraph map = mapped(1.0)->map();
  const std::vector<PointId> points = map.point_ids();
  const std::size_t half = points.size() / 2;
  for (std::size_t i = 0; i < half; ++i) map.remove_point(points[i]);
  Session session = session_on(std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary()));
  reports_of(session, laps_of_room(0.5, 2).frames);
  const std::vector<PointRecord> records = session.point_records();
  ASSERT_GT(records.size(), points.size() - half);
  const auto is_seen = [](const PointRecord& record) { return record.seen > 0; };
  EXPECT_EQ(std::ranges::count_if(std::span(records).first(half), is_seen), 0);
  EXPECT_GT(std::ranges::count_if(records, is_seen), 100);
}

TEST(Mission, IsNotTrustedBeforeEnoughEvidence) {
  const SimulatedMission mission = laps_of_room(0.5, 2);
  SessionOptions options;
  options.mission.registration.accept_log_odds = 8.0;
  options.map_online = false;
  Session session = session_on(mapped(1.0), options);
  std::vector<Frame> frames = mission.frames;
  for (std::size_t i = 0; i < 20; ++i) frames[i] = left_third_of(frames[i]);
  const auto reports = reports_of(session, frames);
  for (std::size_t i = 0; i < 20; ++i) {
    EXPECT_TRUE(reports[i].map_from_body) << i;
    EXPECT_EQ(reports[i].health.doubt, DistrustReason::unconfirmed) << i;
  }
  EXPECT_EQ(reports[30].health.verdict, Verdict::trusted);
}

// Part of the view looks like the other side of the room from the start; the true view appears later.
void expect_to_leave_the_wrong_place(bool map_online) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  SessionOptions options;
  options.mission.registration.accept_log_odds = 8.0;
  options.map_online = map_online;
  Session session = session_on(mapped(1.0), options);
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < kLapFrames / 2; ++i) {
    const Frame elsewhere = left_third_of(mission.frames[i + kLapFrames / 2]);
    frames.push_back(at_time_of(i < 20 ? elsewhere : overlaid(mission.frames[i], elsewhere), mission.frames[i]));
  }
  const auto reports = reports_of(session, frames);
  EXPECT_GT((reports[19].map_from_body->translation - mission.truth[19].world_from_body.translation).norm(), 3.0);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
  EXPECT_EQ(reports.back().health.verdict, Verdict::trusted);
  session.finish();
  const Trajectory final = session.final_trajectory();
  EXPECT_LT(final.size(), frames.size() - 15) << "poses of the wrong place are withdrawn";
  for (const StampedPose& pose : final) {
    const auto truth = std::ranges::find(mission.truth, pose.time, &StampedPose::time);
    EXPECT_THAT(pose.world_from_body, PoseNear(truth->world_from_body, 0.05, kDegree));
  }
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
}

TEST(Mission, LeavesAWrongUnacceptedPlace) {
  expect_to_leave_the_wrong_place(true);
}

TEST(Mission, LeavesAWrongUnacceptedPlaceWithoutMapping) {
  expect_to_leave_the_wrong_place(false);
}

// Frames with a third of their features, overlaid with those of the other side of the room.
std::vector<Frame> seen_as_the_other_side(const SimulatedMission& lap) {
  std::vector<Frame> frames;
  for (std::size_t i = 0; i < kLapFrames / 2; ++i) {
    frames.push_back(at_time_of(overlaid(thinned(lap.frames[i]), lap.frames[i + kLapFrames / 2]), lap.frames[i]));
  }
  return frames;
}

TEST(Mission, LocalisesNearAHintDespiteAMoreSimilarPlace) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  const auto offline = mapped(1.0);
  const std::vector<Frame> frames = seen_as_the_other_side(mission);
  const Pose& truth = mission.truth[0].world_from_body;
  const MapGraph nothing_online(Origin::online);
  const Localisation found = localise(frames[0], mission.rig, {&offline->map(), nothing_online}, offline->places(), {});
  ASSERT_FALSE(found.places_found.empty());
  const Pose most_alike = inverse(found.places_found.front().camera_from_world);
  EXPECT_GT((most_alike.translation - truth.translation).norm(), 3.0);
  Session hinted = session_on(offline);
  hinted.set_initial_pose({.map_from_body = truth * exp_pose((Vector6() << 0.5, 0.5, 0.0, 0.0, 0.0, 0.3).finished())});
  const auto reports = reports_of(hinted, frames);
  ASSERT_TRUE(reports[0].map_from_body);
  EXPECT_THAT(*reports[0].map_from_body, PoseNear(truth, 0.05, kDegree));
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

TEST(Mission, SearchesTheWholeMapAfterAWrongHint) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session session = session_on(mapped(1.0));
  session.set_initial_pose(
      {.map_from_body = mission.truth[kLapFrames / 2].world_from_body, .radius = 1.0, .turn = 1.0, .seconds = 1.0});
  const auto reports = reports_of(session, mission.frames);
  for (std::size_t i = 0; i < 10; ++i) EXPECT_FALSE(reports[i].map_from_body) << i;
  EXPECT_EQ(reports[30].health.verdict, Verdict::trusted);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

// Map whose points are off by some centimetres; its keyframes and their measurements are exact.
std::shared_ptr<const OfflineMap> inexact(const std::shared_ptr<const OfflineMap>& exact) {
  constexpr double kError = 0.02;  // metres
  MapGraph map = exact->map();
  for (const PointId id : map.point_ids()) {
    MapPoint point = *map.find_point(id);
    const double phase = id.number;
    point.position_in_world += kError * Eigen::Vector3d(std::sin(phase), std::sin(2.0 * phase), std::sin(3.0 * phase));
    map.update_point(id, point);
  }
  return std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary());
}

// Offline points are evidence in the last adjustment, with the measurements that they come from.
TEST(Mission, CorrectsErrorsOfTheOfflineMapInItsFinalPoses) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  SessionOptions options;
  options.keyframes.max_shift_share = 0.05;  // keyframes all along the way
  Session session = session_on(inexact(mapped(1.0)), options);
  reports_of(session, mission.frames);
  session.finish();
  const auto error_of = [&](const Trajectory& poses) {
    return absolute_trajectory_error(associate(poses, mission.truth, {}), Scale::fixed)->translation.rmse;
  };
  const double before = error_of(session.final_trajectory());
  session.finish_mission({});
  EXPECT_LT(error_of(session.final_trajectory()), 0.7 * before) << before << " m before";
  const auto offset_of = [&](const Trajectory& poses) {  // metres, in the frame of the offline map
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < poses.size(); ++i) {
      sum += poses[i].world_from_body.translation - mission.truth[i].world_from_body.translation;
    }
    return (sum / static_cast<double>(poses.size())).norm();
  };
  ASSERT_EQ(session.final_trajectory().size(), mission.truth.size());
  EXPECT_LT(offset_of(session.final_trajectory()), 0.01) << "the frame of the map stays";
}

TEST(Mission, AdjustsItsOnlineMapWithTheOfflineMapAtTheEnd) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session session = session_on(mapped(0.4));
  reports_of(session, mission.frames);
  session.finish();
  const Trajectory before = session.final_trajectory();
  session.finish_mission({});
  const Trajectory after = session.final_trajectory();
  ASSERT_EQ(after.size(), mission.truth.size());
  int moved = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_THAT(after[i].world_from_body, PoseNear(mission.truth[i].world_from_body, 0.03, 0.3 * kDegree)) << i;
    moved += (after[i].world_from_body.translation - before[i].world_from_body.translation).norm() > 1e-6 ? 1 : 0;
  }
  EXPECT_GT(moved, kLapFrames / 4);
}

TEST(Mission, LimitsStoredPosesWithoutChangingReports) {
  const SimulatedMission mission = laps_of_room(2.0, 2);
  SessionOptions options;
  options.trajectory.max_poses = 60;
  const auto map = mapped(0.4);
  Session session = session_on(map, options), other = session_on(map);
  const auto reports = reports_of(session, mission.frames), expected = reports_of(other, mission.frames);
  for (std::size_t i = 0; i < reports.size(); ++i) EXPECT_EQ(reports[i].map_from_body, expected[i].map_from_body) << i;
  session.finish();
  session.finish_mission({});
  const Trajectory kept = session.final_trajectory();
  EXPECT_LE(kept.size(), options.trajectory.max_poses);
  EXPECT_EQ(kept.back().time, mission.truth.back().time);
  for (const StampedPose& pose : kept) {
    const auto truth = std::ranges::find(mission.truth, pose.time, &StampedPose::time);
    ASSERT_NE(truth, mission.truth.end());
    EXPECT_THAT(pose.world_from_body, PoseNear(truth->world_from_body, 0.05, 0.5 * kDegree));
  }
}

TEST(Mission, AddsFewKeyframesInAMappedPlace) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session on_map = session_on(mapped(1.0));
  Session plain(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  const auto count_keyframes = [](const std::vector<FrameReport>& reports) {
    return std::ranges::count(reports, true, &FrameReport::keyframe_added);
  };
  EXPECT_LE(8 * count_keyframes(reports_of(on_map, mission.frames)),
            count_keyframes(reports_of(plain, mission.frames)));
}

TEST(Mission, AddsNoKeyframesWithoutMapping) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  SessionOptions options;
  options.map_online = false;
  Session session = session_on(mapped(0.3), options);
  reports_of(session, mission.frames);
  EXPECT_EQ(session.map().online().keyframe_count(), 0);
}

TEST(Mission, ContinuesOutsideTheMappedAreaAndReturns) {
  const SimulatedMission mission = laps_of_room(2.0, 2);
  Session session = session_on(mapped(0.25));
  const auto reports = reports_of(session, mission.frames);
  session.finish();
  EXPECT_TRUE(std::ranges::all_of(reports, [](const FrameReport& report) { return report.map_from_body.has_value(); }));
  EXPECT_GE(count(reports, SessionEvent::left_mapped_area), 1);
  EXPECT_GE(count(reports, SessionEvent::entered_mapped_area), 2);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.2);
  EXPECT_LT(worst_step(reports, mission.truth), 0.05);
  const FrameReport& back = reports[kLapFrames + 10];
  EXPECT_GT(back.health.offline_inliers, 20);
  EXPECT_THAT(*back.map_from_body, PoseNear(mission.truth[kLapFrames + 10].world_from_body, 0.05, kDegree));
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
}

TEST(Mission, NeverTrustsTheMapOfAnotherBuilding) {
  const SimulatedMission mission = laps_of_room(0.5, 2, 99);
  SessionOptions options;
  options.state.lost_after = 2.0;
  Session session = session_on(mapped(1.0), options);
  const auto reports = reports_of(session, mission.frames);
  EXPECT_EQ(count_trusted(reports), 0);
  EXPECT_EQ(count(reports, SessionEvent::navigation_error), 1);
  EXPECT_TRUE(reports.back().odometry_from_body);
  EXPECT_FALSE(reports.back().map_from_body);
  EXPECT_EQ(reports.back().health.doubt, DistrustReason::not_registered);
  EXPECT_LT(worst_step(reports, mission.truth), 0.05);
  EXPECT_TRUE(session.final_trajectory().empty());
}

TEST(Mission, RegistersOnEnteringTheMapFromOutside) {
  SimulatedMission mission = laps_of_room(0.6, 2);
  std::ranges::reverse(mission.truth);
  std::vector<Frame> frames;  // reversed: from outside the map to its first frame
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    frames.push_back(at_time_of(mission.frames[mission.frames.size() - 1 - i], mission.frames[i]));
  }
  Session session = session_on(mapped(0.2));
  const auto reports = reports_of(session, frames);
  session.finish();
  EXPECT_FALSE(reports.front().map_from_body);
  EXPECT_EQ(count(reports, SessionEvent::online_corrected), 1);
  EXPECT_EQ(count(reports, SessionEvent::localised), 1);
  ASSERT_TRUE(reports.back().map_from_body);
  EXPECT_THAT(*reports.back().map_from_body, PoseNear(mission.truth.back().world_from_body, 0.05, kDegree));
  // Earlier poses are in the map's frame as well.
  const Trajectory final = session.final_trajectory();
  ASSERT_EQ(final.size(), frames.size());
  EXPECT_THAT(final.front().world_from_body, PoseNear(mission.truth.front().world_from_body, 0.3, 3 * kDegree));
  EXPECT_LT(worst_step(reports, mission.truth), 0.05);
}

TEST(Mission, IsTrustedAgainSoonAfterDarkness) {
  const SimulatedMission mission = laps_of_room(0.8, 2);
  Session session = session_on(mapped(1.0));
  std::vector<Frame> frames = mission.frames;
  for (std::size_t i = 30; i < 50; ++i) frames[i] = without_features(frames[i]);
  const auto reports = reports_of(session, frames);
  EXPECT_TRUE(reports[30].has(SessionEvent::pose_lost));
  for (std::size_t i = 30; i < 50; ++i) {
    EXPECT_EQ(reports[i].map_from_body, std::nullopt);
    EXPECT_EQ(reports[i].state, State::relocalising);
    EXPECT_EQ(reports[i].health.verdict, Verdict::untrusted);
  }
  EXPECT_TRUE(reports[50].map_from_body);
  EXPECT_EQ(count(reports, SessionEvent::relocalised), 1);
  for (std::size_t i = 55; i < reports.size(); ++i) EXPECT_EQ(reports[i].health.verdict, Verdict::trusted) << i;
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

TEST(Mission, RelocalisesAfterAKidnapping) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session session = session_on(mapped(1.0));
  std::vector<Frame> frames;
  Trajectory truth;
  for (std::size_t i = 0; i < 80; ++i) {
    const std::size_t place = i < 30 ? i : i + 40;  // jump across the room
    frames.push_back(at_time_of(mission.frames[place], mission.frames[i]));
    truth.push_back(mission.truth[place]);
  }
  const auto reports = reports_of(session, frames);
  EXPECT_NE(reports[30].health.verdict, Verdict::trusted);
  for (std::size_t i = 45; i < reports.size(); ++i) EXPECT_EQ(reports[i].health.verdict, Verdict::trusted) << i;
  EXPECT_LT(worst_trusted(reports, truth), 0.03);
}

// Frames 30 to 39 have no features; wheels measure all motion, and the body's pose is that of the frames around.
struct BlindedDrive {
  std::vector<Frame> frames;
  Trajectory by_wheels;
};

std::vector<FrameReport> reports_of(Session& session, const BlindedDrive& drive) {
  session.set_odometry({}, [](Timestamp, Timestamp) { return std::optional(100.0); });
  std::vector<FrameReport> reports;
  for (std::size_t i = 0; i < drive.frames.size(); ++i) {
    std::optional<BodyMotion> motion;
    if (i > 0) motion = inverse(drive.by_wheels[i - 1].world_from_body) * drive.by_wheels[i].world_from_body;
    const bool is_blind = i >= 30 && i < 40;
    reports.push_back(session.process(is_blind ? without_features(drive.frames[i]) : drive.frames[i], motion));
  }
  return reports;
}

TEST(Mission, FollowsWheelsAgainstWeakEvidenceForAnotherPlace) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session session = session_on(mapped(1.0));
  BlindedDrive drive{{}, {}};
  for (std::size_t i = 0; i < 60; ++i) {
    const Frame elsewhere = at_time_of(left_third_of(thinned(mission.frames[i + 40])), mission.frames[i]);
    drive.frames.push_back(i < 40 ? mission.frames[i] : elsewhere);
    drive.by_wheels.push_back(mission.truth[i]);
  }
  const auto reports = reports_of(session, drive);
  for (std::size_t i = 40; i < reports.size(); ++i) {
    ASSERT_TRUE(reports[i].map_from_body) << i;
    EXPECT_LT((reports[i].map_from_body->translation - mission.truth[i].world_from_body.translation).norm(), 0.3) << i;
  }
}

TEST(Mission, RelocalisesAfterAKidnappingWithWheelsStandingStill) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  Session session = session_on(mapped(1.0));
  BlindedDrive drive{{}, {}};
  Trajectory truth;
  for (std::size_t i = 0; i < 80; ++i) {
    const std::size_t place = i < 30 ? i : i + 40;
    drive.frames.push_back(at_time_of(mission.frames[place], mission.frames[i]));
    drive.by_wheels.push_back(mission.truth[std::min<std::size_t>(i, 29)]);
    truth.push_back(mission.truth[place]);
  }
  const auto reports = reports_of(session, drive);
  for (std::size_t i = 60; i < reports.size(); ++i) EXPECT_EQ(reports[i].health.verdict, Verdict::trusted) << i;
  EXPECT_LT(worst_trusted(reports, truth), 0.03);
}

TEST(Mission, SuspendsMovedObjectsAndStaysOnCourse) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  MapGraph map = true_map(laps_of_room(1.0, 1), 4, Origin::offline);
  for (const KeyframeId id : map.keyframe_ids()) {
    map.set_words(id, simulated_vocabulary().words_of(*map.find_keyframe(id)->frame.features));
  }
  for (const PointId id : map.point_ids()) {  // objects in front of a part of one wall
    MapPoint point = *map.find_point(id);
    if (point.position_in_world.x() < 4.0 || std::abs(point.position_in_world.y()) > 0.8) continue;
    point.position_in_world += Eigen::Vector3d(0.0, 0.06, 0.0);
    map.update_point(id, point);
  }
  Session session = session_on(std::make_shared<const OfflineMap>(std::move(map), simulated_vocabulary()));
  const auto reports = reports_of(session, mission.frames);
  EXPECT_GT(reports.back().health.suspended, 10);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

TEST(Mission, DetectsDirtUntilItIsRemoved) {
  constexpr std::size_t kWiped = 2 * kLapFrames, kEnd = 3 * kLapFrames;
  const SimulatedMission mission = laps_of_room(3.0, 2);
  Session session = session_on(mapped(1.0));
  std::vector<Frame> frames = mission.frames;
  for (std::size_t i = 0; i < kWiped; ++i) frames[i] = soiled(frames[i]);
  const auto reports = reports_of(session, frames);

  const Health& dirty = reports[kWiped - 1].health;
  EXPECT_THAT(dirty.hidden_share, testing::AllOf(testing::Gt(0.08), testing::Lt(0.2)));
  EXPECT_THAT(note_on_dirt(dirty), testing::MatchesRegex("dirt hides [0-9]+ % of the left image: clean the lens"));
  EXPECT_LT(dirty.offline_expected, 0.95 * reports[kEnd - 1].health.offline_expected);
  EXPECT_EQ(dirty.verdict, Verdict::trusted);
  EXPECT_EQ(dirty.suspended, 0);
  EXPECT_GE(count(reports, SessionEvent::dirt_found), 1);

  EXPECT_EQ(reports[kEnd - 1].health.hidden_share, 0.0);
  EXPECT_EQ(note_on_dirt(reports[kEnd - 1].health), "");
  EXPECT_EQ(count(reports, SessionEvent::dirt_gone), 1);
  EXPECT_LT(worst_trusted(reports, mission.truth), 0.03);
}

TEST(Mission, DetectsNoDirtOnACleanLens) {
  const SimulatedMission mission = laps_of_room(2.0, 2);
  Session session = session_on(mapped(1.0));
  for (const FrameReport& report : reports_of(session, mission.frames)) ASSERT_EQ(report.health.hidden_share, 0.0);
}

TEST(Mission, ReportsANavigationErrorOnceAndContinuesSearching) {
  const SimulatedMission mission = laps_of_room(1.0, 2);
  SessionOptions options;
  options.state.lost_after = 1.0;
  Session session = session_on(mapped(1.0), options);
  std::vector<Frame> frames = mission.frames;
  for (std::size_t i = 20; i < 50; ++i) frames[i] = without_features(frames[i]);
  const auto reports = reports_of(session, frames);
  EXPECT_EQ(count(reports, SessionEvent::navigation_error), 1);
  EXPECT_EQ(reports[45].state, State::lost);
  EXPECT_EQ(reports.back().state, State::tracking);
  EXPECT_EQ(reports.back().health.verdict, Verdict::trusted);
}

}  // namespace
}  // namespace byre
