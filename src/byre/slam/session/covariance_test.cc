// Consistency of reported covariances with the errors of poses over several simulated missions.

#include "byre/base/sanitizer_scene.h"
#include "byre/slam/session/session.h"
#include "byre/slam/tracking/mission_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

constexpr double kBound95 = 12.592;  // 95 % quantile of chi-square with six degrees of freedom

// Error and reported covariance of one causal pose, both in the body.
struct Judged {
  double seconds = 0.0;  // since the mission began
  Vector6 error = Vector6::Zero();
  Matrix6 covariance = Matrix6::Zero();

  bool within_bound() const { return error.dot(covariance.ldlt().solve(error)) <= kBound95; }
};

SimulatedMission simulate(const Trajectory& truth, std::uint64_t seed) {
  SimulationOptions options;
  options.seed = seed;
  options.noise_seed = seed;
  options.pixel_sigma = 0.8;  // sigma of a corner without a patch
  return simulate_mission(simulated_rig(robot_from_camera()), truth, options);
}

// Judges all frames but the first, whose pose defines the world and is exact.
std::vector<Judged> judge(const SimulatedMission& mission) {
  Session session(mission.rig, {}, make_inline_executor());
  std::vector<Judged> judged;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(mission.frames[i]);
    if (i == 0 || !report.map_from_body) continue;
    const Pose true_world_from_body = inverse(mission.truth[0].world_from_body) * mission.truth[i].world_from_body;
    judged.push_back(
        {to_seconds(report.time), log_pose(inverse(*report.map_from_body) * true_world_from_body), report.covariance});
  }
  return judged;
}

double share_within_bound(const std::vector<Judged>& judged) {
  return static_cast<double>(std::ranges::count_if(judged, &Judged::within_bound)) / static_cast<double>(judged.size());
}

TEST(ReportedCovariance, BoundsNinetyFivePercentOfErrors) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  constexpr std::uint64_t kSeeds = 8;
  const std::vector<Trajectory> trajectories = {circling_trajectory(90, 15.0, 2.0, 0.75, robot_from_camera()),
                                                turning_in_place_trajectory(75, 15.0, 0.75, robot_from_camera()),
                                                figure_eight_trajectory(90, 15.0, 4.0, 0.6, robot_from_camera())};
  std::vector<Judged> all;
  for (const Trajectory& trajectory : trajectories) {
    std::vector<Judged> of_trajectory;
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const std::vector<Judged> mission = judge(simulate(trajectory, seed));
      of_trajectory.insert(of_trajectory.end(), mission.begin(), mission.end());
    }
    // All frames of a mission share its drift, so single trajectories scatter more than their union.
    EXPECT_GE(share_within_bound(of_trajectory), 0.85);
    all.insert(all.end(), of_trajectory.begin(), of_trajectory.end());
  }
  EXPECT_THAT(share_within_bound(all), AllOf(Ge(0.90), Le(0.99)));
}

}  // namespace
}  // namespace byre
