#include "byre/playback/report/mission_report.h"

#include "byre/map/keyframe_path.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::SizeIs;

Pose pose_after(double x) {
  return {rotation_exp({0.0, 0.0, 0.1 * x}), {x, 0.1 * x * x, 0.0}};
}

const Pose kTruthFromMap{rotation_exp({0.0, 0.0, 1.0}), {5.0, 6.0, 7.0}};

// Ten seconds of poses at 10 Hz.
Trajectory truth() {
  Trajectory result;
  for (int i = 0; i <= 100; ++i) result.push_back({from_seconds(0.1 * i), kTruthFromMap * pose_after(0.1 * i)});
  return result;
}

MapGraph offline_map() {
  MapGraph map(Origin::offline);
  map.add_rig({});
  for (int i = 0; i < 4; ++i) {
    Keyframe keyframe;
    keyframe.frame.time = from_seconds(2 * i);
    keyframe.camera_from_world = inverse(pose_after(2.0 * i));
    map.add_keyframe(keyframe);
  }
  return map;
}

MapAlignment aligned_map() {
  return align_to_truth(keyframe_path(offline_map()), Scale::fixed, truth());
}

// Frames every 0.5 s, each with the given error along its x axis, metres, and a sigma of 1 cm.
RunResult run_with_errors(const std::vector<double>& errors_m, Verdict verdict = Verdict::trusted) {
  RunResult run;
  for (std::size_t i = 0; i < errors_m.size(); ++i) {
    const double time_s = 0.5 * static_cast<double>(i);
    FrameReport report;
    report.time = from_seconds(time_s);
    report.map_from_body = pose_after(time_s) * Pose{Eigen::Quaterniond::Identity(), {errors_m[i], 0.0, 0.0}};
    report.covariance = 1e-4 * Matrix6::Identity();
    report.health.verdict = verdict;
    run.causal.push_back({report.time, *report.map_from_body});
    PlayedFrame frame;
    frame.time = report.time;
    frame.report = report;
    run.frames.push_back(frame);
  }
  run.final = run.causal;
  return run;
}

TEST(MissionErrors, AreInTheMapFrame) {
  const MissionErrors errors = mission_errors(run_with_errors({0.1, 0.1, 0.1, 0.1}), aligned_map(), truth());
  EXPECT_TRUE(errors.in_map_frame);
  EXPECT_EQ(errors.alignment_poses, 4);
  EXPECT_NEAR(position_statistics(errors.causal).rmse, 0.1, 1e-9) << "a constant error is not aligned away";
  EXPECT_NEAR(position_statistics(errors.final).rmse, 0.1, 1e-9);
}

TEST(MissionErrors, CountWronglyTrustedFrames) {
  RunResult run = run_with_errors({0.0, 0.3, 0.0, 0.3, 0.3, 0.3, 0.3, 0.0});
  run.frames[6].report->health.verdict = Verdict::degraded;
  const MissionErrors errors = mission_errors(run, aligned_map(), truth());
  EXPECT_THAT(errors.trusted, SizeIs(7));
  EXPECT_THAT(errors.degraded, SizeIs(1));
  EXPECT_EQ(errors.wrongly_trusted, 4);
  EXPECT_NEAR(errors.longest_wrong_trust_s, 1.0, 1e-9) << "from the fourth frame to the sixth";
}

TEST(MissionErrors, CompareErrorsWithTheirCovariance) {
  // The 95 % bound for three degrees of freedom is 2.8 sigmas.
  const RunResult run = run_with_errors({0.0, 0.027, 0.029, 0.1});
  EXPECT_EQ(mission_errors(run, aligned_map(), truth()).within_bound, 0.5);
}

TEST(MissionErrors, SkipUnreadableFramesAndFramesWithoutPose) {
  RunResult run = run_with_errors({0.0, 0.0, 0.0, 0.0});
  run.frames[1].report.reset();
  run.frames[2].report->map_from_body.reset();
  run.causal.erase(run.causal.begin() + 1, run.causal.begin() + 3);
  const MissionErrors errors = mission_errors(run, aligned_map(), truth());
  EXPECT_THAT(errors.causal, SizeIs(2));
  EXPECT_THAT(errors.trusted, SizeIs(2));
  EXPECT_THAT(errors.final, SizeIs(4));
}

TEST(MissionErrors, AreEmptyWithoutTruthAtTheSameTime) {
  const MissionErrors errors = mission_errors(run_with_errors({0.0, 0.0}), aligned_map(), {});
  EXPECT_THAT(errors.causal, SizeIs(0));
  EXPECT_EQ(errors.within_bound, std::nullopt);
}

TEST(AlignedErrors, AlignTheRunItself) {
  const MissionErrors errors = aligned_errors(run_with_errors({0.0, 0.0, 0.0, 0.0, 0.0}), truth(), Scale::fixed);
  EXPECT_FALSE(errors.in_map_frame);
  EXPECT_NEAR(position_statistics(errors.causal).max, 0.0, 1e-9);
  EXPECT_THAT(errors.final, SizeIs(5));
  EXPECT_THAT(aligned_errors(run_with_errors({0.0, 0.0}), truth(), Scale::fixed).causal, SizeIs(0))
      << "too few to align";
}

}  // namespace
}  // namespace byre
