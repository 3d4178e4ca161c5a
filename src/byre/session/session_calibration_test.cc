// Missions in a world that has not changed, by a camera whose calibration errs: a smooth field of errors in the image,
// the same in every frame, which no number of points averages out.

#include "byre/alignment.h"
#include "byre/session/session_scene.h"
#include "byre/slam/place_scene.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

constexpr int kFrames = 90;

// Pixels at the corners of the image, as an error of focal length, of the principal point and of the lens makes them.
struct SeenError {
  double zoom = 0.0;
  double shift = 0.0;
  double lens = 0.0;
  double disparity = 0.0;
};

Frame seen_through(const SeenError& error, const Frame& frame, const Rig& rig) {
  std::vector<Keypoint> keypoints = to_vector(frame.features->keypoints());
  for (Keypoint& keypoint : keypoints) {
    const double x = 2.0 * keypoint.pixel.x() / rig.width - 1.0;
    const double y = 2.0 * keypoint.pixel.y() / rig.height - 1.0;
    const double u = error.zoom * x + error.shift + error.lens * std::sin(std::numbers::pi * x) * (1.0 - y * y);
    const double v = error.zoom * y - 0.5 * error.shift + error.lens * std::sin(std::numbers::pi * y) * (1.0 - x * x);
    keypoint.pixel += Eigen::Vector2d(u, v).cast<float>();
    if (keypoint.has_disparity()) keypoint.disparity += static_cast<float>(error.disparity);
  }
  return {frame.time, std::make_shared<const Features>(rig.width, rig.height, std::move(keypoints),
                                                       to_vector(frame.features->descriptors()), std::vector<Patch>{})};
}

SimulatedMission visit(std::uint64_t noise_seed) {
  SimulationOptions options;
  options.noise_seed = noise_seed;
  options.pixel_sigma = 0.2;
  options.disparity_sigma = 0.1;
  return simulate_mission(simulated_rig(), circling_trajectory(kFrames, 10.0, 2.0, 0.75), options);
}

std::shared_ptr<const OfflineMap> mapped_circle() {
  return offline_map_of(visit(1));
}

struct CalibrationOutcome {
  double error = 0.0;            // metres, root mean square over the frames that have a pose
  double worst_trusted = 0.0;    // metres
  double offline_inliers = 0.0;  // a frame
  int poses = 0;
};

double error_of(const Pose& body, const StampedPose& truth) {
  return (body.translation - truth.world_from_body.translation).norm();
}

CalibrationOutcome outcome_of(Session session, const SimulatedMission& mission, const SeenError& error) {
  CalibrationOutcome outcome;
  double squared = 0.0;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(seen_through(error, mission.frames[i], mission.rig));
    if (!report.map_from_body) continue;
    const double off = error_of(*report.map_from_body, mission.truth[i]);
    squared += off * off;
    outcome.offline_inliers += report.health.offline_inliers;
    if (report.health.verdict == Verdict::trusted) outcome.worst_trusted = std::max(outcome.worst_trusted, off);
    ++outcome.poses;
  }
  outcome.error = std::sqrt(squared / outcome.poses);
  outcome.offline_inliers /= outcome.poses;
  return outcome;
}

CalibrationOutcome mission_outcome(bool map_online, const SeenError& error) {
  static const std::shared_ptr<const OfflineMap> offline = mapped_circle();
  const SimulatedMission mission = visit(2);
  SessionOptions options;
  options.map_online = map_online;
  return outcome_of({mission.rig, options, Lanes(make_inline_executor()), simulated_vocabulary(), offline}, mission,
                    error);
}

// Without any map, laid over the truth as well as it goes.
double error_without_map(const SeenError& error) {
  const SimulatedMission mission = visit(2);
  Session session(mission.rig, {}, Lanes(make_inline_executor()));
  std::vector<Eigen::Vector3d> estimated, truth;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    const FrameReport report = session.process(seen_through(error, mission.frames[i], mission.rig));
    if (!report.map_from_body) continue;
    estimated.push_back(report.map_from_body->translation);
    truth.push_back(mission.truth[i].world_from_body.translation);
  }
  const auto truth_from_map = align(estimated, truth, Scale::fixed);
  double squared = 0.0;
  for (std::size_t i = 0; i < truth.size(); ++i) squared += (*truth_from_map * estimated[i] - truth[i]).squaredNorm();
  return std::sqrt(squared / static_cast<double>(truth.size()));
}

class MissionWithCalibrationError : public ::testing::TestWithParam<SeenError> {};

TEST_P(MissionWithCalibrationError, IsNoWorseForMappingBesideTheOfflineMap) {
  constexpr double kNoise = 0.002;  // metres: what two runs differ by anyhow
  const CalibrationOutcome hybrid = mission_outcome(true, GetParam());
  const CalibrationOutcome localised = mission_outcome(false, GetParam());
  EXPECT_EQ(hybrid.poses, kFrames);
  EXPECT_LE(hybrid.error, 1.1 * localised.error + kNoise);
  // An error of the zoom shifts every pose on an exact map: no mission that does not calibrate itself can know.
  EXPECT_LE(hybrid.error, std::max(localised.error, 1.1 * error_without_map(GetParam())) + kNoise);
  EXPECT_GT(hybrid.offline_inliers, 0.5 * localised.offline_inliers);
  EXPECT_LT(hybrid.worst_trusted, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Errors, MissionWithCalibrationError,
                         ::testing::Values(SeenError{}, SeenError{.zoom = 1.0}, SeenError{.shift = 1.0},
                                           SeenError{.lens = 2.0}, SeenError{.disparity = 0.3},
                                           SeenError{.zoom = -1.0, .shift = 0.7, .lens = -1.5, .disparity = -0.2}));

// As the simulated rig has it.
Calibration calibration_of(const Rig& rig) {
  Calibration calibration;
  calibration.left = {CameraModel::pinhole, rig.width, rig.height, rig.focal, rig.focal, rig.cx, rig.cy, {}};
  Pose right_from_left;
  right_from_left.translation.x() = -rig.baseline;
  calibration.right = {calibration.left, right_from_left};
  return calibration;
}

TEST(MappingWithACalibration, IsTrustedOnceThatHasBeenLookedAt) {
  const SimulatedMission mission = visit(2);
  Session session(mission.rig, {}, Lanes(make_inline_executor()));
  session.refine_calibration(calibration_of(mission.rig), {});
  bool was_looked_at = false;
  for (const Frame& frame : mission.frames) {
    const FrameReport report = session.process(frame);
    was_looked_at = was_looked_at || report.has(SessionEvent::recalibrated);
    EXPECT_EQ(report.health.verdict == Verdict::trusted, was_looked_at) << to_seconds(report.time) << " s";
    EXPECT_TRUE(was_looked_at || report.health.doubt == Doubt::unconfirmed);
  }
  EXPECT_TRUE(was_looked_at);
}

}  // namespace
}  // namespace byre
