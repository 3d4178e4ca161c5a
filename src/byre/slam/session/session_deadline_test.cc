// Sessions with a deadline that is shorter than the time of a frame: skipped work and its effects.

#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/session/session_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kFramesInTime = 120;

SimulatedMission timed_lap(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  return simulate_mission(simulated_rig(), circling_trajectory(kFramesInTime, 10.0, 2.0, 1.0), options);
}

// A clock that advances by a second at each call.
FrameBudget budget_always_spent() {
  return FrameBudget(1e-3, [now = 0.0]() mutable { return now += 1.0; });
}

std::vector<FrameReport> reports_in_time(Session& session, FrameBudget& budget, const std::vector<Frame>& frames) {
  std::vector<FrameReport> reports;
  for (const Frame& frame : frames) {
    budget.begin();
    FrameReport report = session.process(frame, {}, &budget);
    budget.end();
    report.cuts = budget.cuts();
    report.is_late = budget.is_late();
    reports.push_back(std::move(report));
  }
  return reports;
}

int count_pressed(const std::vector<FrameReport>& reports) {
  return static_cast<int>(
      std::ranges::count_if(reports, [](const FrameReport& report) { return report.cuts.online_points; }));
}

TEST(Deadline, KeepsOfflinePointsInAMission) {
  const auto offline = offline_map_of(timed_lap(1));
  const SimulatedMission mission = timed_lap(2);
  Session session(simulated_rig(), {}, SessionExecutors(make_inline_executor(), make_inline_executor()),
                  simulated_vocabulary(), offline);
  FrameBudget budget = budget_always_spent();
  const auto reports = reports_in_time(session, budget, mission.frames);
  EXPECT_GT(count_pressed(reports), kFramesInTime - 10);
  for (std::size_t i = 10; i < reports.size(); ++i) {
    ASSERT_TRUE(reports[i].map_from_body) << i;
    EXPECT_THAT(*reports[i].map_from_body, PoseNear(mission.truth[i].world_from_body, 0.03, 0.01)) << i;
    EXPECT_EQ(reports[i].health.verdict, Verdict::trusted) << i;
    if (reports[i].cuts.online_points) {
      EXPECT_EQ(reports[i].health.online_inliers, 0) << i;
    }
  }
}

TEST(Deadline, KeepsKeyframesInMapping) {
  const SimulatedMission mission = timed_lap(1);
  Session whole(mission.rig, {}, make_inline_executor());
  reports_of(whole, mission.frames);
  Session pressed(mission.rig, {}, make_inline_executor());
  FrameBudget budget = budget_always_spent();
  const auto reports = reports_in_time(pressed, budget, mission.frames);
  EXPECT_GT(count_pressed(reports), kFramesInTime / 2);
  EXPECT_THAT(reports, testing::Each(testing::Field(&FrameReport::state, State::tracking)));
  EXPECT_GT(2 * pressed.map().online().keyframe_count(), whole.map().online().keyframe_count());
  EXPECT_LT(pressed.map().online().keyframe_count(), 2 * whole.map().online().keyframe_count());
  const Pose& start = mission.truth.front().world_from_body;
  const Pose moved = inverse(*reports.front().map_from_body) * *reports.back().map_from_body;
  EXPECT_THAT(moved, PoseNear(inverse(start) * mission.truth.back().world_from_body, 0.05, 0.02));
}

TEST(Deadline, CutsNothingAfterALostFrame) {
  const SimulatedMission mission = timed_lap(1);
  Session session(mission.rig, {}, make_inline_executor());
  FrameBudget budget = budget_always_spent();
  std::vector<Frame> frames(mission.frames.begin(), mission.frames.begin() + 20);
  frames[12] = without_features(frames[12]);
  const auto reports = reports_in_time(session, budget, frames);
  EXPECT_TRUE(reports[11].cuts.online_points);
  EXPECT_FALSE(reports[12].map_from_body);
  EXPECT_FALSE(reports[13].cuts.online_points);
  EXPECT_TRUE(reports[13].map_from_body);
}

}  // namespace
}  // namespace byre
