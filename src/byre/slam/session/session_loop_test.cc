// Sessions with place recognition: loops, relocalisation, and maps that stop growing.

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_file.h"
#include "byre/simulation/simulated_mission_scene.h"
#include "byre/slam/session/session_scene.h"
#include "byre/slam/window/online_copy.h"

#include <algorithm>
#include <fstream>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kLap = 60;  // frames

SimulatedMission laps(double count, std::uint64_t noise_seed = 1) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  const int frames = static_cast<int>(kLap * count);
  return simulate_mission(simulated_rig(), circling_trajectory(frames, 10.0, 2.0, count), options);
}

Session recognising_session(const Rig& rig) {
  return {rig, {}, SessionExecutors(make_inline_executor(), make_inline_executor()), simulated_vocabulary()};
}

// Metres from the true position in the frame of the first pose.
double error_of(const SimulatedMission& mission, std::size_t frame, const Pose& world_from_body) {
  const Pose truth = inverse(mission.truth[0].world_from_body) * mission.truth[frame].world_from_body;
  return (world_from_body.translation - truth.translation).norm();
}

int parts_of(const Session& session) {
  return quality_of(session.map().online()).parts;
}

struct MissionResult {
  int loops = 0;
  int corrections = 0;
  double last_error = 0.0;  // metres, mean over the last ten causal poses
};

MissionResult run(Session& session, const SimulatedMission& mission) {
  MissionResult result;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(mission.frames[i]);
    EXPECT_TRUE(report.map_from_body) << "frame " << i;
    if (!report.map_from_body) continue;
    result.loops += report.has(SessionEvent::loop_found);
    result.corrections += report.has(SessionEvent::map_corrected);
    if (i + 10 >= mission.frames.size()) result.last_error += 0.1 * error_of(mission, i, *report.map_from_body);
  }
  session.finish();
  return result;
}

TEST(SessionWithVocabulary, ClosesTheLoopOnReturn) {
  const SimulatedMission mission = laps(1.3);
  Session without(mission.rig, {}, make_inline_executor());
  const MissionResult open = run(without, mission);
  Session session = recognising_session(mission.rig);
  const MissionResult closed = run(session, mission);
  EXPECT_EQ(closed.loops, 1);
  EXPECT_LT(closed.last_error, 0.6 * open.last_error);
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
  EXPECT_EQ(parts_of(session), 1);
}

TEST(SessionWithVocabulary, FindsNoLoopWithoutAReturn) {
  const SimulatedMission mission = laps(0.8);
  Session session = recognising_session(mission.rig);
  for (const Frame& frame : mission.frames) EXPECT_FALSE(session.process(frame).has(SessionEvent::loop_found));
}

#ifdef BYRE_SANITIZED
constexpr bool kMemoryIsOurs = false;  // sanitizers keep freed memory
#else
constexpr bool kMemoryIsOurs = true;
#endif

double resident_pages() {
  double total = 0.0, resident = 0.0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident;
}

TEST(SessionWithVocabulary, BoundsTheMapOnARepeatedPath) {
  const SimulatedMission mission = laps(20.0);
  Session session = recognising_session(mission.rig);
  std::vector<int> keyframes, points;  // after each lap
  std::vector<double> memory;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    ASSERT_TRUE(session.process(mission.frames[i]).map_from_body);
    if ((i + 1) % kLap != 0) continue;
    keyframes.push_back(session.map().online().keyframe_count());
    points.push_back(session.map().online().point_count());
    memory.push_back(resident_pages());
  }
  EXPECT_LE(keyframes[19], 1.3 * keyframes[2]);
  EXPECT_LE(points[19], 1.3 * points[2]);
  if (kMemoryIsOurs) {
    EXPECT_LE(memory[19], 1.3 * memory[2]);
  }
}

TEST(SessionWithVocabulary, RelocalisesAfterALoss) {
  const SimulatedMission mission = laps(1.0);
  Session session = recognising_session(mission.rig);
  for (std::size_t i = 0; i < 40; ++i) ASSERT_TRUE(session.process(mission.frames[i]).map_from_body);
  Frame blind = mission.frames[40];
  blind.features = std::make_shared<Features>();
  EXPECT_EQ(session.process(blind).state, State::relocalising);

  Frame somewhere = mission.frames[10];  // an earlier place, not the one where the pose was lost
  somewhere.time = mission.frames[41].time;
  const FrameReport found = session.process(somewhere);
  EXPECT_EQ(found.state, State::tracking);
  EXPECT_TRUE(found.has(SessionEvent::relocalised));
  ASSERT_TRUE(found.map_from_body);
  EXPECT_LT(error_of(mission, 10, *found.map_from_body), 0.05);
}

TEST(SessionWithVocabulary, ContinuesAnEarlierMap) {
  const SimulatedMission first = laps(0.5), second = laps(1.0, 2);
  Session earlier = recognising_session(first.rig);
  for (const Frame& frame : first.frames) earlier.process(frame);
  earlier.finish();
  const int keyframes_before = earlier.map().online().keyframe_count();

  SessionOptions options;
  options.recording = 1;
  Session later(second.rig, options, SessionExecutors(make_inline_executor(), make_inline_executor()),
                simulated_vocabulary());
  later.continue_map(online_copy(offline_copy(earlier.map().online())));
  for (std::size_t i = 10; i < second.frames.size(); ++i) {
    const FrameReport report = later.process(second.frames[i]);
    ASSERT_TRUE(report.map_from_body) << "frame " << i;
    EXPECT_LT(error_of(second, i, *report.map_from_body), 0.1);
  }
  later.finish();
  const MapGraph& map = later.map().online();
  EXPECT_THAT(find_faults(map), testing::IsEmpty());
  EXPECT_GT(map.keyframe_count(), keyframes_before);
  EXPECT_EQ(map.find_keyframe(map.keyframe_ids().front())->recording, 0);
  EXPECT_EQ(map.find_keyframe(map.keyframe_ids().back())->recording, 1);
  EXPECT_EQ(parts_of(later), 1);
}

TEST(SessionWithVocabulary, IsDeterministic) {
  const SimulatedMission mission = laps(1.3);
  const auto bytes = [&] {
    Session session(mission.rig, {}, SessionExecutors(make_paced_executor(3), make_paced_executor(7)),
                    simulated_vocabulary());
    for (const Frame& frame : mission.frames) session.process(frame);
    session.finish();
    session.finish_map({});
    StoredMap stored;
    stored.map = offline_copy(session.map().online());
    return write_map(stored);
  };
  EXPECT_EQ(bytes(), bytes());
}

// Jobs read snapshots of the map, whose state is that of their request on any executor.
TEST(SessionWithVocabulary, ReturnsTheSameMapWithInlineAndConcurrentIndexing) {
  const SimulatedMission mission = laps(1.3);
  const auto bytes = [&](std::unique_ptr<Executor> index) {
    Session session(
        mission.rig, {},
        SessionExecutors(make_inline_executor(), make_inline_executor(), make_inline_executor(), std::move(index)),
        simulated_vocabulary());
    EXPECT_EQ(run(session, mission).loops, 1);
    StoredMap stored;
    stored.map = offline_copy(session.map().online());
    return write_map(stored);
  };
  EXPECT_EQ(bytes(make_inline_executor()), bytes(make_paced_executor(1)));
}

TEST(SessionWithVocabulary, ExtendsTheMapWhileAJobReadsIt) {
  const SimulatedMission mission = laps(1.4);
  Session session(mission.rig, {},
                  SessionExecutors(make_inline_executor(), make_inline_executor(), make_inline_executor(),
                                   make_paced_executor(12)),  // frames, more than between two keyframes
                  simulated_vocabulary());
  int frames_since_keyframe = 12, added_meanwhile = 0;
  for (const Frame& frame : mission.frames) {
    const FrameReport report = session.process(frame);
    ASSERT_EQ(report.state, State::tracking);
    added_meanwhile += report.keyframe_added && frames_since_keyframe < 12;
    frames_since_keyframe = report.keyframe_added ? 0 : frames_since_keyframe + 1;
  }
  EXPECT_GT(added_meanwhile, 3);
  session.finish();
  const MapGraph& map = session.map().online();
  EXPECT_THAT(find_faults(map), testing::IsEmpty());
  for (const KeyframeId id : map.keyframe_ids()) EXPECT_FALSE(map.find_keyframe(id)->words.empty());
}

TEST(SessionWithVocabulary, MovesKeyframesAddedDuringACorrection) {
  const SimulatedMission mission = laps(1.6);
  SessionOptions options;
  options.max_drift_to_fuse = 0.0;  // corrects the whole map after any drift
  Session session(mission.rig, options, SessionExecutors(make_paced_executor(2), make_paced_executor(15)),
                  simulated_vocabulary());
  const MissionResult closed = run(session, mission);
  EXPECT_GE(closed.corrections, 1);
  EXPECT_LT(closed.last_error, 0.05);  // noise level; a keyframe left behind would exceed it
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
}

TEST(SessionWithVocabulary, FinishesEarlyWithAValidMapWhenHurried) {
  const SimulatedMission mission = laps(1.2);
  SessionOptions options;
  options.max_drift_to_fuse = 0.0;
  Session session(mission.rig, options, SessionExecutors(make_paced_executor(2), make_paced_executor(1000)),
                  simulated_vocabulary());
  for (const Frame& frame : mission.frames) session.process(frame);
  session.finish_early();
  session.finish();
  EXPECT_FALSE(session.loops().empty());
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
  EXPECT_EQ(session.final_trajectory().size(), mission.frames.size());
}

TEST(SessionWithVocabulary, FinishesItsMap) {
  const SimulatedMission mission = laps(1.2);
  Session session = recognising_session(mission.rig);
  for (const Frame& frame : mission.frames) session.process(frame);
  session.finish();
  std::vector<std::string> steps;
  FinishHooks hooks;
  hooks.before_step = [&steps](const char* step) { steps.emplace_back(step); };
  const FinishReport report = session.finish_map(hooks);
  EXPECT_EQ(steps.size(), 3u);
  EXPECT_GE(report.points_removed, 0);
  EXPECT_EQ(report.after.parts, 1);
  EXPECT_LE(report.after.reprojection_p95, 1.1 * report.before.reprojection_p95);
  EXPECT_THAT(find_faults(session.map().online()), testing::IsEmpty());
  EXPECT_EQ(session.final_trajectory().size(), mission.frames.size());
}

}  // namespace
}  // namespace byre
