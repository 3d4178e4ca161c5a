// Missions in an unchanged world with a calibration error: a smooth field of image errors, equal in all frames, which
// does not average out over points.

#include "byre/alignment.h"
#include "byre/base/sanitizer_scene.h"
#include "byre/features/recalibrated.h"
#include "byre/slam/places/place_scene.h"
#include "byre/slam/session/session_scene.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::IsEmpty;

constexpr int kFrames = 90;

// Errors at the image corners, pixels, due to focal length, principal point and lens.
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
  double error = 0.0;            // metres, root mean square over frames with a pose
  double worst_trusted = 0.0;    // metres
  double offline_inliers = 0.0;  // mean of a frame
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
  return outcome_of({mission.rig, options, SessionExecutors(make_inline_executor()), simulated_vocabulary(), offline},
                    mission, error);
}

// SLAM without an offline map, aligned with the truth.
double error_without_map(const SeenError& error) {
  const SimulatedMission mission = visit(2);
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()));
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

TEST_P(MissionWithCalibrationError, IsNoWorseWithOnlineMapping) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  constexpr double kNoise = 0.002;  // metres, difference between two runs
  const CalibrationOutcome hybrid = mission_outcome(true, GetParam());
  const CalibrationOutcome localised = mission_outcome(false, GetParam());
  EXPECT_EQ(hybrid.poses, kFrames);
  EXPECT_LE(hybrid.error, 1.1 * localised.error + kNoise);
  // A zoom error shifts every pose on an exact map; only self-calibration can detect it.
  EXPECT_LE(hybrid.error, std::max(localised.error, 1.1 * error_without_map(GetParam())) + kNoise);
  EXPECT_GT(hybrid.offline_inliers, 0.5 * localised.offline_inliers);
  EXPECT_LT(hybrid.worst_trusted, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Errors, MissionWithCalibrationError,
                         ::testing::Values(SeenError{}, SeenError{.zoom = 1.0},
                                           SeenError{.zoom = -1.0, .shift = 0.7, .lens = -1.5, .disparity = -0.2}));
// Single errors of the kinds that the last mission above combines.
INSTANTIATE_TEST_SUITE_P(LongRunErrors, MissionWithCalibrationError,
                         ::testing::Values(SeenError{.shift = 1.0}, SeenError{.lens = 2.0},
                                           SeenError{.disparity = 0.3}));

Calibration calibration_of(const Rig& rig) {
  Calibration calibration;
  calibration.left = {CameraModel::pinhole, rig.width, rig.height, rig.focal, rig.focal, rig.cx, rig.cy, {}};
  Pose right_from_left;
  right_from_left.translation.x() = -rig.baseline;
  calibration.right = {calibration.left, right_from_left};
  return calibration;
}

TEST(MappingWithACalibration, IsTrustedOnceTheCalibrationIsChecked) {
  const SimulatedMission mission = visit(2);
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()));
  session.refine_calibration(calibration_of(mission.rig), {});
  bool was_looked_at = false;
  for (const Frame& frame : mission.frames) {
    const FrameReport report = session.process(frame);
    was_looked_at = was_looked_at || report.has(SessionEvent::recalibrated);
    EXPECT_EQ(report.health.verdict == Verdict::trusted, was_looked_at) << to_seconds(report.time) << " s";
    EXPECT_TRUE(was_looked_at || report.health.doubt == DistrustReason::unconfirmed);
  }
  EXPECT_TRUE(was_looked_at);
}

// Jobs take several frames, in which keyframes are added.
TEST(MappingWithACalibration, RectifiesEveryKeyframeByTheRefinedCalibration) {
  const SimulatedMission mission = visit(2);
  const Calibration real = calibration_of(mission.rig);
  CalibrationVector error = CalibrationVector::Zero();
  error[kRightRotation] = 1.5;
  error[kRightRotation + 1] = -2.0;
  const Calibration given = changed(real, error);
  const RectifiedChange given_from_real(real, given);
  Session session(given_from_real.rig(), {},
                  {make_paced_executor(2), make_paced_executor(4), make_inline_executor(), make_paced_executor(3)});
  session.refine_calibration(given, {});
  std::map<Timestamp, Features> frames;
  int refined = 0;
  for (const Frame& frame : mission.frames) {
    const Features& shown = frames.emplace(frame.time, recalibrated(*frame.features, given_from_real)).first->second;
    const FrameReport report = session.process({frame.time, std::make_shared<const Features>(shown)});
    refined += report.has(SessionEvent::recalibrated) ? 1 : 0;
  }
  session.finish();
  EXPECT_GE(refined, 2);
  EXPECT_THAT(find_faults(session.map().online()), IsEmpty());

  constexpr float kPrecise = 0.05f;  // pixels; repeated changes accumulate rounding errors
  const RectifiedChange refined_from_given(given, session.self_calibration()->calibration);
  for (const KeyframeId id : session.map().online().keyframe_ids()) {
    const Keyframe& keyframe = *session.map().online().find_keyframe(id);
    const Features& found = *keyframe.frame.features;
    const Features expected = recalibrated(frames.at(keyframe.frame.time), refined_from_given);
    ASSERT_EQ(found.size(), expected.size());
    for (int i = 0; i < found.size(); ++i) {
      EXPECT_LT((found.keypoint(i).pixel - expected.keypoint(i).pixel).norm(), kPrecise);
      const Sighting& sighting = keyframe.sightings[static_cast<std::size_t>(i)];
      const bool is_held = !sighting.point || (sighting.pixel - found.keypoint(i).pixel).norm() < kPrecise;
      EXPECT_TRUE(is_held) << sighting.pixel.transpose() << " pixels";
    }
  }
}

}  // namespace
}  // namespace byre
