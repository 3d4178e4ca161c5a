// Monocular sessions: mapping by one camera, and missions on a stereo map.

#include "byre/base/sanitizer_scene.h"
#include "byre/slam/session/session_scene.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <utility>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;

constexpr int kFramesOfALap = 120;  // frames, at 10 Hz

Rig one_camera() {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  return rig;
}

SimulationOptions noisy_visit(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.landmarks = 8000;
  options.noise_seed = noise_seed;
  return options;
}

SimulatedMission circling(const Rig& rig, double laps, std::uint64_t noise_seed) {
  const int frames = static_cast<int>(kFramesOfALap * laps);
  return simulate_mission(rig, circling_trajectory(frames, 10.0, 2.0, laps), noisy_visit(noise_seed));
}

SimulatedMission turning_in_place(const Rig& rig) {
  return simulate_mission(rig, turning_in_place_trajectory(100, 10.0, 1.0), noisy_visit(2));
}

Session session_of(const Rig& rig, std::shared_ptr<const OfflineMap> offline = nullptr) {
  return {rig,
          {},
          SessionExecutors(make_inline_executor(), make_inline_executor()),
          simulated_vocabulary(),
          std::move(offline)};
}

std::vector<bool> has_pose(const std::vector<FrameReport>& reports) {
  std::vector<bool> result;
  for (const FrameReport& report : reports) result.push_back(report.map_from_body.has_value());
  return result;
}

TEST(Monocular, StartsAMapAfterMotionAndTracksUpToScale) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const SimulatedMission mission = circling(one_camera(), 1.0, 2);
  Session session = session_of(one_camera());
  const auto reports = reports_of(session, mission.frames);
  const auto first = std::ranges::find_if(reports, [](const FrameReport& r) { return r.map_from_body.has_value(); });
  ASSERT_NE(first, reports.end());
  EXPECT_TRUE(first->has(SessionEvent::initialised));
  EXPECT_LT(first - reports.begin(), 30);
  EXPECT_EQ(std::ranges::count(has_pose(reports), false), first - reports.begin());
  session.finish();
  const auto error = absolute_trajectory_error(associate(session.final_trajectory(), mission.truth, {}), Scale::free);
  ASSERT_TRUE(error);
  EXPECT_LT(error->translation.rmse, 0.02);
}

TEST(Monocular, DoesNotStartDuringATurnOnTheSpotAndReportsWhy) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  Session session = session_of(one_camera());
  const auto reports = reports_of(session, turning_in_place(one_camera()).frames);
  EXPECT_THAT(has_pose(reports), Each(false));
  EXPECT_GT(std::ranges::count(reports, TwoViewFailure::rotation_only, &FrameReport::start_failure), 20);
}

TEST(Monocular, MapsTheFirstKeyframesOfFewPointsWithoutTheLatencyOfThePace) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  constexpr int kLatency = 8;  // frames
  const SimulatedMission mission = circling(one_camera(), 1.0, 2);
  SessionOptions options;
  options.keyframes.min_tracked = 2000;  // every frame has few points
  Session session(one_camera(), options, SessionExecutors(make_paced_executor(kLatency)));
  int frames_of_job = 0, longest_in_young_map = 0, longest_later = 0;
  for (const Frame& frame : mission.frames) {
    const bool is_young = session.map().online().keyframe_count() < 10;
    const FrameReport report = session.process(frame);
    if (session.map().online().keyframe_count() == 0) continue;
    ++frames_of_job;
    if (!report.job_seconds) continue;
    int& longest = is_young ? longest_in_young_map : longest_later;
    longest = std::max(longest, std::exchange(frames_of_job, 0));
  }
  EXPECT_GT(longest_in_young_map, 0);
  EXPECT_LT(longest_in_young_map, kLatency);
  EXPECT_GE(longest_later, kLatency);
}

TEST(Monocular, TracksATurnOnTheSpotInAMap) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  SimulatedMission mapping = turning_in_place(simulated_rig());
  Session session = session_of(one_camera(), offline_map_of(mapping));
  SimulationOptions options = noisy_visit(3);
  const SimulatedMission mission = simulate_mission(one_camera(), turning_in_place_trajectory(100, 10.0, 1.0), options);
  EXPECT_THAT(has_pose(reports_of(session, mission.frames)), Each(true));
}

TEST(Monocular, HasTheScaleOfItsOfflineMap) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  Session session = session_of(one_camera(), offline_map_of(circling(simulated_rig(), 1.0, 1)));
  const SimulatedMission mission = circling(one_camera(), 1.0, 2);
  const auto reports = reports_of(session, mission.frames);
  for (std::size_t i = 0; i < reports.size(); ++i) {
    ASSERT_TRUE(reports[i].map_from_body) << "frame " << i;
    EXPECT_LT((reports[i].map_from_body->translation - mission.truth[i].world_from_body.translation).norm(), 0.03)
        << "frame " << i;
  }
}

TEST(Monocular, WaitsForRelocalisationInsteadOfASecondMap) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  SimulationOptions another_room = noisy_visit(2);
  another_room.seed = 99;
  Session session = session_of(one_camera(), offline_map_of(circling(simulated_rig(), 1.0, 1)));
  const auto reports = reports_of(
      session, simulate_mission(one_camera(), circling_trajectory(40, 10.0, 2.0, 0.33), another_room).frames);
  EXPECT_THAT(has_pose(reports), Each(false));
  EXPECT_EQ(session.map().online().keyframe_count(), 0);
}

double error_of(const Session& session, const SimulatedMission& mission) {
  return absolute_trajectory_error(associate(session.final_trajectory(), mission.truth, {}), Scale::free)
      ->translation.rmse;
}

// Two laps without the frames of a gap, in which the camera moves on by a sixth of a lap.
class LostForGood : public ::testing::Test {
 protected:
  static constexpr int kGap = 40, kAfterGap = 60;  // frames

  SimulatedMission laps_ = circling(one_camera(), 2.0, 2);
  Session session_ = session_of(one_camera());
  std::vector<FrameReport> run(int end) {
    std::vector<Frame> frames(laps_.frames.begin(), laps_.frames.begin() + kGap);
    frames.insert(frames.end(), laps_.frames.begin() + kAfterGap, laps_.frames.begin() + end);
    return reports_of(session_, frames);
  }
};

TEST_F(LostForGood, BeginsASubmapWithoutPosesInTheMapAndJoinsItAfterTheReturn) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto reports = run(160);
  EXPECT_EQ(std::ranges::count_if(reports, [](const auto& r) { return r.has(SessionEvent::restarted); }), 1);
  EXPECT_EQ(std::ranges::count_if(reports, [](const auto& r) { return r.has(SessionEvent::relocalised); }), 1);
  EXPECT_FALSE(reports[kGap + 20].map_from_body) << "in the submap";
  EXPECT_NE(reports[kGap + 20].health.verdict, Verdict::trusted);
  session_.finish();
  session_.finish_map({});
  EXPECT_TRUE(session_.frames_not_joined().empty());
  EXPECT_GT(session_.final_trajectory().size(), 100u) << "of 140";
  EXPECT_LT(error_of(session_, laps_), 0.02);
}

TEST_F(LostForGood, LeavesOutASubmapThatShowsNoPlaceOfTheMap) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  run(90);
  const Timestamp begin = laps_.frames[kAfterGap].time;
  session_.finish();
  session_.finish_map({});
  EXPECT_GT(session_.frames_not_joined().size(), 10u);
  EXPECT_THAT(session_.final_trajectory(), Each(::testing::Field(&StampedPose::time, ::testing::Lt(begin))));
  const MapGraph& map = session_.map().online();
  for (const KeyframeId id : map.keyframe_ids()) EXPECT_LT(map.find_keyframe(id)->frame.time, begin);
}

TEST(Monocular, ClosesItsLoopsAndMovesItsFramesAlong) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  SimulationOptions options = noisy_visit(2);
  options.landmarks = 5000;
  const SimulatedMission mission = simulate_mission(one_camera(), circling_trajectory(160, 10.0, 2.0, 1.33), options);
  Session open(one_camera(), {}, SessionExecutors(make_inline_executor()));
  reports_of(open, mission.frames);
  open.finish();
  Session session = session_of(one_camera());
  reports_of(session, mission.frames);
  session.finish();
  EXPECT_EQ(session.loops().size(), 1u);
  EXPECT_LT(error_of(session, mission), 0.75 * error_of(open, mission));
  session.finish_map({});
  EXPECT_LT(error_of(session, mission), 0.01);
}

}  // namespace
}  // namespace byre
