// Whether a session knows how precise its poses are: its errors over several simulated missions against the
// covariances it reports.

#include "byre/session/session.h"
#include "byre/slam/mission_scene.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::AllOf;
using ::testing::Ge;
using ::testing::Le;

constexpr double kBound95 = 12.592;  // 95 % of chi-square with six degrees of freedom

// One causal pose: its error as seen in the body, and the covariance reported with it.
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
  options.pixel_sigma = 0.8;  // what a corner without a patch is taken to have
  return simulate_mission(simulated_rig(robot_from_camera()), truth, options);
}

// The first pose defines the world and is exact.
std::vector<Judged> judge(const SimulatedMission& mission) {
  Session session(mission.rig, {}, make_inline_executor());
  std::vector<Judged> judged;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(mission.frames[i]);
    if (i == 0 || !report.world_from_body) continue;
    const Pose true_world_from_body = inverse(mission.truth[0].world_from_body) * mission.truth[i].world_from_body;
    judged.push_back({to_seconds(report.time), log_pose(inverse(*report.world_from_body) * true_world_from_body),
                      report.covariance});
  }
  return judged;
}

std::vector<Judged> judge_seeds(const Trajectory& truth) {
  constexpr std::uint64_t kSeeds = 8;
  std::vector<Judged> all;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    const std::vector<Judged> mission = judge(simulate(truth, seed));
    all.insert(all.end(), mission.begin(), mission.end());
  }
  return all;
}

struct NamedTrajectory {
  const char* name;
  Trajectory (*make)();
};

class ReportedCovariance : public ::testing::TestWithParam<NamedTrajectory> {};

TEST_P(ReportedCovariance, BoundsNineteenErrorsInTwenty) {
  const std::vector<Judged> all = judge_seeds(GetParam().make());
  const auto within = static_cast<double>(std::ranges::count_if(all, &Judged::within_bound));
  EXPECT_THAT(within / static_cast<double>(all.size()), AllOf(Ge(0.90), Le(0.99)));
}

INSTANTIATE_TEST_SUITE_P(
    On, ReportedCovariance,
    ::testing::Values(NamedTrajectory{"Circling",
                                      [] { return circling_trajectory(90, 15.0, 2.0, 0.75, robot_from_camera()); }},
                      NamedTrajectory{"TurningInPlace",
                                      [] { return turning_in_place_trajectory(75, 15.0, 0.75, robot_from_camera()); }},
                      NamedTrajectory{"FigureEight",
                                      [] { return figure_eight_trajectory(90, 15.0, 4.0, 0.6, robot_from_camera()); }}),
    [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace byre
