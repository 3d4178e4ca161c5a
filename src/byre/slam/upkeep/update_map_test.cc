#include "byre/slam/upkeep/update_map.h"

#include "byre/slam/places/place_scene.h"
#include "byre/slam/session/session.h"
#include "byre/slam/upkeep/additions.h"
#include "byre/slam/upkeep/place_budget.h"

#include <array>
#include <set>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::uint64_t kId = 0x1234;
constexpr std::uint64_t kRoom = 1, kOtherRoom = 2;

SimulatedMission circling(double laps, std::uint64_t noise_seed, std::uint64_t room = kRoom) {
  SimulationOptions options;
  options.seed = room;
  options.noise_seed = noise_seed;
  return simulate_mission(simulated_rig(), circling_trajectory(static_cast<int>(120 * laps), 10.0, 2.0, laps), options);
}

Calibration calibration() {
  const Rig rig = simulated_rig();
  const Camera camera{CameraModel::pinhole, rig.width, rig.height, rig.focal, rig.focal, rig.cx, rig.cy};
  return {camera, StereoPartner{camera, {Eigen::Quaterniond::Identity(), {-rig.baseline, 0.0, 0.0}}},
          rig.body_from_camera};
}

MapVersion version_of(const SimulatedMission& visit) {
  MapVersion version;
  version.id = kId;
  version.stored.map = offline_copy(offline_map_of(visit)->map());
  version.stored.recordings = {{"day", calibration()}};
  version.stored.vocabulary_checksum = simulated_vocabulary().checksum();
  return version;
}

StoredSession session_of(const SimulatedMission& mission, const MapVersion& version) {
  const auto offline = std::make_shared<const OfflineMap>(version.stored.map, simulated_vocabulary());
  Session session(simulated_rig(), {}, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  simulated_vocabulary(), offline);
  StoredSession stored{"evening", {}, {}};
  for (const Frame& frame : mission.frames) {
    const FrameReport report = session.process(frame);
    ++stored.record.frames;
    if (!report.map_from_body) continue;
    PoseRecord& pose = stored.record.poses.emplace_back();
    pose.time = report.time;
    pose.map_from_body = *report.map_from_body;
    pose.verdict = static_cast<std::uint8_t>(report.health.verdict);
  }
  session.finish();
  const MapGraph map = standalone_copy(session.map());
  stored.stored.map = offline_copy(map);
  stored.stored.recordings = {{"evening", calibration()}};
  stored.record.map_id = version.id;
  stored.record.copied_points = static_cast<std::uint32_t>(std::ranges::count_if(
      map.point_ids(), [&](PointId id) { return session.map().online().find_point(id) == nullptr; }));
  stored.record.points = session.point_records();
  return stored;
}

MapUpdate updated(const MapVersion& version, const std::vector<StoredSession>& sessions) {
  return update_map(version, sessions, simulated_vocabulary());
}

std::set<std::array<double, 3>> positions(const MapGraph& map) {
  std::set<std::array<double, 3>> positions;
  for (const PointId id : map.point_ids()) {
    const Eigen::Vector3d& position = map.find_point(id)->position_in_world;
    positions.insert({position.x(), position.y(), position.z()});
  }
  return positions;
}

// Share of frames that the map finds, each within 5 cm of the truth.
double share_found(const MapGraph& map, const SimulatedMission& mission) {
  const PlaceIndex index = index_of(map, simulated_vocabulary());
  int found = 0, frames = 0;
  for (std::size_t i = 0; i < mission.frames.size(); i += 6, ++frames) {
    const std::array<ReplayFrame, 1> frame{ReplayFrame{mission.frames[i], mission.rig, {}}};
    const Replayed place = replay(frame, map, index).front();
    if (!place.camera_from_world) continue;
    const Pose error = *place.camera_from_world * inverse(true_camera_from_world(mission, i));
    found += error.translation.norm() < 0.05;
  }
  return static_cast<double>(found) / frames;
}

// A map of a third of the room's lap, and a mission on the whole lap.
class MapUpdates : public testing::Test {
 protected:
  MapVersion parent_ = version_of(circling(0.4, 1));
  StoredSession session_ = session_of(circling(1.0, 2), parent_);
};

TEST_F(MapUpdates, AddPlacesThatTheMapLacks) {
  const MapUpdate update = updated(parent_, {session_});
  ASSERT_TRUE(update.child) << update.refusal << update.sessions[0].place.fault;
  EXPECT_GT(update.sessions[0].keyframes_added, 3);
  EXPECT_GT(update.sessions[0].points_added, 300);
  EXPECT_THAT(find_faults(*update.child), IsEmpty());
  const SimulatedMission later = circling(1.0, 3);
  EXPECT_LT(share_found(parent_.stored.map, later), 0.7);
  EXPECT_GT(share_found(update.child->map, later), 0.85);
}

// Where the map itself is known to 6 cm only, the drift of a mission beyond it adds to that.
TEST_F(MapUpdates, AddNoPlaceWhoseDriftFromTheMapIsLarge) {
  constexpr double kSigma = 0.06;  // metres
  const MapGraph online = online_beside(session_, parent_.stored.map);
  const std::size_t near_a_good_map = keyframes_to_add(parent_.stored.map, parent_.stored.map, online).size();
  MapGraph vague = parent_.stored.map;
  const Matrix6 covariance = kSigma * kSigma / 3.0 * Matrix6::Identity();
  for (const KeyframeId id : vague.keyframe_ids()) vague.move_keyframe(id, vague.camera_from_world(id), covariance);
  EXPECT_LT(keyframes_to_add(vague, vague, online).size(), near_a_good_map / 2);
}

TEST_F(MapUpdates, MoveNoPointAndNoKeyframeThatStays) {
  for (PoseRecord& pose : session_.record.poses) pose.verdict = static_cast<std::uint8_t>(Verdict::trusted);
  const MapUpdate update = updated(parent_, {session_});
  ASSERT_TRUE(update.child);
  const StoredMap written = read_map(write_map(parent_.stored), "parent");
  const StoredMap child = read_map(write_map(*update.child), "child");
  const auto before = positions(written.map), after = positions(child.map);
  EXPECT_EQ(update.points_retired, 0);
  EXPECT_TRUE(std::ranges::includes(after, before));
  for (const KeyframeId id : written.map.keyframe_ids()) {
    const Pose &stays = child.map.find_keyframe(id)->camera_from_world,
               &was = written.map.find_keyframe(id)->camera_from_world;
    EXPECT_EQ(stays.translation, was.translation);
    EXPECT_EQ(stays.rotation.coeffs(), was.rotation.coeffs());
  }
}

TEST_F(MapUpdates, RefuseSessionsWithAReason) {
  for (PoseRecord& pose : session_.record.poses) pose.verdict = static_cast<std::uint8_t>(Verdict::trusted);
  const auto fault_with = [&](auto change) {
    StoredSession session = session_;
    change(session);
    const MapUpdate update = updated(parent_, {session});
    EXPECT_FALSE(update.child);
    EXPECT_EQ(update.refusal, "no session fits the map");
    return update.sessions[0].place.fault;
  };
  EXPECT_THAT(fault_with([](StoredSession& session) { session.record.map_id = 7; }), HasSubstr("ran on another map"));
  EXPECT_THAT(fault_with([](StoredSession& session) {
                for (PoseRecord& pose : session.record.poses) {
                  pose.verdict = static_cast<std::uint8_t>(Verdict::untrusted);
                }
              }),
              HasSubstr("has a trusted pose in 0 of"));
  EXPECT_THAT(fault_with([](StoredSession& session) {
                for (PoseRecord& pose : session.record.poses) pose.map_from_body.translation.z() += 5.0;
              }),
              HasSubstr("was never on the map"));
  EXPECT_THAT(fault_with([](StoredSession& session) {
                session.stored.recordings[0].calibration.left.fx *= 1.05;
                session.stored.recordings[0].calibration.left.fy *= 1.05;
              }),
              HasSubstr("has another calibration than the map"));
  EXPECT_THAT(fault_with([](StoredSession& session) { session.stored.recordings[0].calibration.left.width = 64; }),
              HasSubstr("images of another size"));
  EXPECT_THAT(fault_with([&](StoredSession& session) {
                const MapVersion elsewhere = version_of(circling(0.4, 1, kOtherRoom));
                session.stored.map = session_of(circling(1.0, 2, kOtherRoom), elsewhere).stored.map;
                session.record.copied_points = 0;
              }),
              HasSubstr("is not found in the map"));
  EXPECT_THAT(fault_with([](StoredSession& session) {
                MapGraph moved(Origin::offline);
                moved = session.stored.map;
                for (const KeyframeId id : moved.keyframe_ids()) {
                  const Keyframe& keyframe = *moved.find_keyframe(id);
                  moved.move_keyframe(id,
                                      keyframe.camera_from_world * Pose{Eigen::Quaterniond::Identity(), {0.3, 0, 0}},
                                      keyframe.covariance);
                }
                session.stored.map = moved;
              }),
              HasSubstr("contradicts the map"));
}

// A mission may confirm its place late.
TEST_F(MapUpdates, UseSessionsThatAreTrustedInPart) {
  std::vector<PoseRecord>& poses = session_.record.poses;
  ASSERT_GT(poses.size(), 20u);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    poses[i].verdict = static_cast<std::uint8_t>(3 * i < poses.size() ? Verdict::trusted : Verdict::untrusted);
  }
  const MapUpdate update = updated(parent_, {session_});
  EXPECT_EQ(update.sessions[0].place.fault, "");
  ASSERT_TRUE(update.child) << update.refusal;
  EXPECT_GT(update.sessions[0].keyframes_added, 0);
  ASSERT_EQ(update.sessions[0].places.size(), update.places.size()) << "of one session";
  EXPECT_EQ(update.sessions[0].places[0].found_after, update.places[0].found_after);
}

TEST_F(MapUpdates, RetirePointsThatMissionsMissRepeatedly) {
  StoredSession session = session_;
  constexpr std::uint32_t kGone = 20;
  for (std::uint32_t i = 0; i < kGone; ++i) session.record.points[7 * i] = {40, 0, 0, 30.0f};
  const MapUpdate once = updated(parent_, {session});
  ASSERT_TRUE(once.child) << once.refusal << once.sessions[0].place.fault;
  EXPECT_EQ(once.points_retired, 0) << "one mission may be mistaken";
  const MapUpdate often = updated(parent_, {session, session, session, session});
  ASSERT_TRUE(often.child) << often.refusal;
  EXPECT_EQ(often.points_retired, kGone);
  EXPECT_EQ(often.survival.size(), static_cast<std::size_t>(often.child->map.point_count()));
}

TEST_F(MapUpdates, NeedKeyframesOfTheMission) {
  SimulatedMission mission = circling(0.4, 2);
  mission.frames.resize(10);
  const StoredSession session = session_of(mission, parent_);
  EXPECT_THAT(updated(parent_, {session}).sessions[0].place.fault, HasSubstr("mapped too little to be placed"));
}

TEST_F(MapUpdates, IgnorePartsThatNoPointConnectsToTheMap) {
  const MapGraph online = online_beside(session_, parent_.stored.map);
  MapGraph apart(Origin::online);
  apart.add_rig(online.rigs()[0]);
  for (const KeyframeId id : online.keyframe_ids()) {
    Keyframe keyframe = *online.find_keyframe(id);
    for (Sighting& sighting : keyframe.sightings) sighting.point.reset();
    apart.add_keyframe(std::move(keyframe));
  }
  EXPECT_FALSE(keyframes_to_add(parent_.stored.map, parent_.stored.map, online).empty());
  EXPECT_THAT(keyframes_to_add(parent_.stored.map, parent_.stored.map, apart), IsEmpty());
}

TEST_F(MapUpdates, TakeAPlaceFromOneMissionOnly) {
  for (PoseRecord& pose : session_.record.poses) pose.verdict = static_cast<std::uint8_t>(Verdict::trusted);
  StoredSession again = session_of(circling(1.0, 4), parent_);
  const MapUpdate update = updated(parent_, {session_, again});
  ASSERT_TRUE(update.child) << update.refusal;
  EXPECT_LT(update.sessions[1].keyframes_added, update.sessions[0].keyframes_added / 2);
}

TEST(SessionSummary, KeepsSeparateKeyframesUpToALimit) {
  const SimulatedMission mission = circling(1.0, 1);
  MapGraph map = true_map(mission, 1, Origin::online);
  for (const KeyframeId id : map.keyframe_ids()) {
    if (id.number == 0) continue;
    ASSERT_EQ(map.find_keyframe(id)->parent->number, id.number - 1);
  }
  const int keyframes = map.keyframe_count();
  thin_out(map, 1000);
  EXPECT_LT(map.keyframe_count(), keyframes);
  EXPECT_GT(map.keyframe_count(), 20);
  thin_out(map, 20);
  EXPECT_LE(map.keyframe_count(), 20);
  EXPECT_GT(map.keyframe_count(), 8);
  for (const PointId id : map.point_ids()) EXPECT_GE(map.observations(id).size(), 2u);
  EXPECT_THAT(find_faults(map), IsEmpty());
}

TEST_F(MapUpdates, AreNotedInTheChild) {
  for (PoseRecord& pose : session_.record.poses) pose.verdict = static_cast<std::uint8_t>(Verdict::trusted);
  MapUpdate update = updated(parent_, {session_});
  ASSERT_TRUE(update.child);
  const std::vector<MapHistory> history = history_of(*update.child);
  ASSERT_EQ(history.size(), 1u);
  EXPECT_EQ(history[0].parent, kId);
  EXPECT_THAT(history[0].change, HasSubstr("evening: "));
  const MapVersion child{0x5678, *std::move(update.child), update.survival};
  const MapUpdate again = updated(child, {session_});
  EXPECT_EQ(again.sessions[0].place.fault, "") << "it ran on the parent";
  EXPECT_FALSE(again.sessions[0].has_records);
  ASSERT_TRUE(again.child) << again.refusal;
  EXPECT_EQ(history_of(*again.child).size(), 2u);
}

TEST(MapSummaries, KeepWhatLocalisationNeeds) {
  const MapVersion parent = version_of(circling(3.0, 1));
  const MapUpdate summary = summarise_map(parent, 6, simulated_vocabulary());
  ASSERT_TRUE(summary.child) << summary.refusal;
  const MapGraph &before = parent.stored.map, &after = summary.child->map;
  EXPECT_LT(after.keyframe_count(), before.keyframe_count() / 2);
  EXPECT_EQ(summary.keyframes_removed, before.keyframe_count() - after.keyframe_count());
  EXPECT_TRUE(std::ranges::includes(positions(before), positions(after))) << "points do not move";
  EXPECT_THAT(find_faults(*summary.child), IsEmpty());
  EXPECT_EQ(summary.survival.size(), static_cast<std::size_t>(after.point_count()));
  const SimulatedMission later = circling(1.0, 3);
  EXPECT_GE(share_found(after, later), share_found(before, later));
  EXPECT_EQ(history_of(*summary.child).front().parent, kId);
  EXPECT_THAT(summarise_map(parent, 1, simulated_vocabulary()).refusal, HasSubstr("no keyframe can be spared"))
      << "one alone localises nothing";
  EXPECT_THAT(summarise_map(parent, 1000, simulated_vocabulary()).refusal, HasSubstr("no keyframe can be spared"));
}

TEST_F(MapUpdates, ReplaceAMapOnlyByAVersionThatIsAsGood) {
  for (PoseRecord& pose : session_.record.poses) pose.verdict = static_cast<std::uint8_t>(Verdict::trusted);
  MapUpdate update = updated(parent_, {session_});
  ASSERT_TRUE(update.child);
  const MapVersion child{0x5678, *std::move(update.child), update.survival};
  const auto fault = [&](const MapVersion& map, const MapVersion& next) {
    return fault_of_replacement(map, next, session_, simulated_vocabulary());
  };
  EXPECT_EQ(fault(parent_, child), "");
  MapVersion other = version_of(circling(0.4, 1, kOtherRoom));
  other.id = 0x9abc;
  EXPECT_THAT(fault(parent_, other), HasSubstr("places would be worse than before"));
  EXPECT_THAT(fault(other, child), HasSubstr("it is not proved, as session evening ran on another map"));
  EXPECT_EQ(fault(child, parent_), "") << "the child was made of it";
}

TEST(PlaceProof, FindsPlacesThatBecomeWorse) {
  const SimulatedMission mission = quarter_circle(without_noise());
  std::vector<ReplayFrame> frames;
  std::vector<Replayed> before;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    frames.push_back({mission.frames[i], mission.rig, true_camera_from_world(mission, i)});
    before.push_back({frames.back().camera_from_world, 1e-10 * Matrix6::Identity(), 100});
  }
  const auto faults_after = [&](auto change) {
    std::vector<Replayed> after = before;
    for (Replayed& frame : after) change(frame);
    std::string faults;
    for (const PlaceProof& place : compare_places(frames, before, after)) faults += place.fault;
    return faults;
  };
  EXPECT_EQ(faults_after([](Replayed&) {}), "");
  EXPECT_THAT(faults_after([](Replayed& frame) { frame.camera_from_world.reset(); }),
              HasSubstr("frames are found instead"));
  EXPECT_THAT(faults_after([](Replayed& frame) { frame.inliers = 80; }), HasSubstr("points fit instead of"));
  EXPECT_THAT(faults_after([](Replayed& frame) { frame.camera_from_world->translation.z() += 0.02; }),
              HasSubstr("poses move by "));
  EXPECT_EQ(faults_after([](Replayed& frame) { frame.camera_from_world->translation.z() += 0.004; }), "");
  const auto move_away = [](Replayed& frame) { frame.camera_from_world->translation.z() += 5.0; };
  EXPECT_THAT(faults_after(move_away), HasSubstr("frames are found instead")) << "away from the poses of the mission";
  std::ranges::for_each(before, move_away);
  EXPECT_EQ(faults_after([](Replayed& frame) { frame.camera_from_world->translation.z() -= 5.0; }), "")
      << "places that the map before confused";
}

// A building that repeats looks alike from outside its map.
TEST_F(MapUpdates, PlaceASessionByItsKeyframesOnTheMap) {
  std::vector<ReplayFrame> frames = frames_to_replay(parent_.stored.map);
  std::vector<Replayed> found;
  for (ReplayFrame& frame : frames) found.push_back({frame.camera_from_world, 1e-6 * Matrix6::Identity(), 100});
  const std::size_t outside = frames.size() / 2;
  for (std::size_t i = 0; i < outside; ++i) frames[i].camera_from_world.translation.z() += 50.0;
  const auto place = [&] { return place_of(frames, found, parent_.stored.map); };
  EXPECT_EQ(place().fault, "");
  EXPECT_EQ(place().found, static_cast<int>(frames.size() - outside));
  found[outside].camera_from_world->translation.z() += 0.5;
  EXPECT_EQ(place().fault, "") << "one is never enough";
  for (std::size_t i = outside + 1; i < outside + 3; ++i) found[i].camera_from_world->translation.z() += 0.5;
  EXPECT_THAT(place().fault, HasSubstr("contradicts the map: 3 of its"));
}

// Two places of a whole mission may be found by chance in a building that has become another.
TEST_F(MapUpdates, RefuseASessionOfWhichFewKeyframesOnTheMapAreFound) {
  std::vector<ReplayFrame> frames = frames_to_replay(parent_.stored.map);
  const std::vector<ReplayFrame> once = frames;
  while (frames.size() < 50) frames.insert(frames.end(), once.begin(), once.end());
  std::vector<Replayed> found(frames.size());
  const auto fault_with = [&](std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) found[i] = {frames[i].camera_from_world, 1e-6 * Matrix6::Identity(), 100};
    return place_of(frames, found, parent_.stored.map).fault;
  };
  EXPECT_THAT(fault_with(2), HasSubstr("is not found in the map: 2 of its"));
  EXPECT_EQ(fault_with(frames.size() / 10 + 1), "");
}

}  // namespace
}  // namespace byre
