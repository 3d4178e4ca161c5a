// Sessions with a rolling shutter that the calibration does not model.

#include "byre/alignment.h"
#include "byre/base/sanitizer_scene.h"
#include "byre/slam/calibration/rolling_scene.h"
#include "byre/slam/session/session_scene.h"

#include <cmath>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr double kReadoutTime = 0.02;  // seconds

SimulatedMission visit_by_rolling_shutter(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  options.pixel_sigma = 0.2;
  options.disparity_sigma = 0.1;
  return simulate_mission(simulated_rig(), figure_eight_trajectory(450, 20.0, 4.0, 2.0), options);
}

RefinedCalibration given() {
  RefinedCalibration calibration;
  calibration.calibration.left = {CameraModel::pinhole, 752, 480, 430.0, 430.0, 375.5, 239.5, {}};
  return calibration;
}

struct RollingShutterOutcome {
  double error = 0.0;  // metres, root mean square over the second half
  double readout_time = 0.0;
};

// A mission on the map of another visit, or SLAM aligned with the truth.
RollingShutterOutcome outcome_of(const SimulatedMission& mission, bool has_map, bool is_refined) {
  static const std::shared_ptr<const OfflineMap> offline = offline_map_of(visit_by_rolling_shutter(1));
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary(),
                  has_map ? offline : nullptr);
  if (is_refined) session.refine_readout(given());
  std::vector<Eigen::Vector3d> estimated, truth;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(mission.frames[i]);
    if (!report.map_from_body || 2 * i < mission.frames.size()) continue;
    estimated.push_back(report.map_from_body->translation);
    truth.push_back(mission.truth[i].world_from_body.translation);
  }
  RollingShutterOutcome outcome;
  if (const auto calibration = session.self_calibration()) outcome.readout_time = calibration->calibration.readout_time;
  const Similarity truth_from_map = has_map ? Similarity{} : align(estimated, truth, Scale::fixed).value();
  for (std::size_t i = 0; i < truth.size(); ++i)
    outcome.error += (truth_from_map * estimated[i] - truth[i]).squaredNorm();
  outcome.error = std::sqrt(outcome.error / static_cast<double>(truth.size()));
  return outcome;
}

TEST(SessionShutter, EstimatesTheReadoutTimeInAMission) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const SimulatedMission mission = rolling(visit_by_rolling_shutter(2), kReadoutTime);
  const RollingShutterOutcome refined = outcome_of(mission, true, true), as_given = outcome_of(mission, true, false);
  EXPECT_NEAR(refined.readout_time, kReadoutTime, 2e-3);
  EXPECT_LT(refined.error, 0.5 * as_given.error);
}

TEST(SessionShutter, IsZeroForAGlobalShutter) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  for (const bool has_map : {true, false}) {
    const RollingShutterOutcome refined = outcome_of(visit_by_rolling_shutter(2), has_map, true),
                                as_given = outcome_of(visit_by_rolling_shutter(2), has_map, false);
    EXPECT_EQ(refined.readout_time, 0.0);
    EXPECT_EQ(refined.error, as_given.error);
  }
}

}  // namespace
}  // namespace byre
