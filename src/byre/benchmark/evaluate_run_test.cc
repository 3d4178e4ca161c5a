#include "byre/benchmark/measures.h"

#include <cmath>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::Field;
using testing::Optional;
using testing::SizeIs;

constexpr int kFrames = 100;
constexpr Timestamp kInterval = std::chrono::milliseconds(50);

Timestamp time_of(int frame) {
  return frame * kInterval;
}

// A rising circle of radius 2 m at 0.4 m/s.
Pose true_pose(int frame) {
  const double angle = 0.01 * frame;
  return {Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
          {2.0 * std::cos(angle), 2.0 * std::sin(angle), 0.002 * frame}};
}

Trajectory truth() {
  Trajectory poses;
  for (int i = 0; i < kFrames; ++i) poses.push_back({time_of(i), true_pose(i)});
  return poses;
}

// The map's origin is 5 m along x in the truth; all poses have the same error of 10 mm along z.
const Pose kTruthFromMap{Eigen::Quaterniond::Identity(), {5.0, 0.0, 0.0}};
constexpr double kOffset = 0.01;  // metres

Pose estimated_pose(int frame) {
  Pose pose = inverse(kTruthFromMap) * true_pose(frame);
  pose.translation.z() += kOffset;
  return pose;
}

PlayedFrame frame_with_pose(int index, double sigma) {
  PlayedFrame frame;
  frame.time = time_of(index);
  FrameReport report;
  report.time = frame.time;
  report.state = State::tracking;
  report.map_from_body = estimated_pose(index);
  report.covariance = sigma * sigma * Matrix6::Identity();
  report.health.verdict = Verdict::trusted;
  frame.report = report;
  frame.seconds.total = 0.01;
  return frame;
}

// Only frames first to last have a pose.
RunResult run_with_poses(int first, int last, double sigma) {
  RunResult run;
  for (int i = 0; i < kFrames; ++i) {
    PlayedFrame frame = frame_with_pose(i, sigma);
    if (i < first || i > last) {
      frame.report->map_from_body.reset();
      frame.report->health = {};
    } else {
      run.causal.push_back({frame.time, *frame.report->map_from_body});
    }
    run.frames.push_back(frame);
  }
  run.final = run.causal;
  return run;
}

const Trajectory kTruth = truth();
const RunTruth kOnMap{kTruth, MapAlignment{{1.0, kTruthFromMap}, 20}};
const RunTruth kWithoutMap{kTruth, {}};

TEST(Judge, SeparatesErrorsWithAndWithoutAlignment) {
  const RunMeasures measures = evaluate_run(run_with_poses(0, kFrames - 1, 0.01), kOnMap);
  for (const TrajectoryMeasures& poses : {measures.final_poses, measures.causal_poses}) {
    EXPECT_THAT(poses.coverage, Optional(1.0));
    EXPECT_THAT(poses.ate, Optional(DoubleNear(0.0, 1e-9)));
    EXPECT_THAT(poses.map_error, Optional(DoubleNear(kOffset, 1e-9)));
    EXPECT_THAT(poses.map_error_median, Optional(DoubleNear(kOffset, 1e-9)));
    EXPECT_THAT(poses.map_error_max, Optional(DoubleNear(kOffset, 1e-9)));
    EXPECT_THAT(poses.rpe_frame, Optional(DoubleNear(0.0, 1e-9)));
    EXPECT_THAT(poses.rpe_second, Optional(DoubleNear(0.0, 1e-9)));
    EXPECT_THAT(poses.rpe_metre, Optional(DoubleNear(0.0, 1e-9)));
  }
}

TEST(Judge, HasNoErrorInTheMapFrameWithoutAMap) {
  const RunMeasures measures = evaluate_run(run_with_poses(0, kFrames - 1, 0.01), kWithoutMap);
  EXPECT_FALSE(measures.final_poses.map_error);
  EXPECT_FALSE(measures.behaviour.within_bound);
  EXPECT_FALSE(measures.behaviour.wrongly_trusted);
  EXPECT_TRUE(measures.final_poses.ate);
}

TEST(Judge, CountsFramesWithoutPose) {
  const RunMeasures measures = evaluate_run(run_with_poses(20, 69, 0.01), kOnMap);
  EXPECT_THAT(measures.causal_poses.coverage, Optional(DoubleNear(0.5, 1e-12)));
  EXPECT_THAT(measures.behaviour.first_pose, Optional(DoubleNear(1.0, 1e-9)));
  EXPECT_THAT(measures.behaviour.trusted_share, Optional(DoubleNear(0.5, 1e-12)));
}

TEST(Judge, MeasuresARunWithoutPoses) {
  const RunMeasures measures = evaluate_run(run_with_poses(kFrames, kFrames, 0.01), kOnMap);
  EXPECT_THAT(measures.final_poses.coverage, Optional(0.0));
  EXPECT_FALSE(measures.final_poses.ate);
  EXPECT_FALSE(measures.final_poses.map_error);
  EXPECT_FALSE(measures.behaviour.first_pose);
  EXPECT_THAT(measures.behaviour.trusted_share, Optional(0.0));
}

TEST(Judge, ComparesErrorsWithTheirCovariance) {
  EXPECT_THAT(evaluate_run(run_with_poses(0, 99, 0.01), kOnMap).behaviour.within_bound, Optional(1.0));
  EXPECT_THAT(evaluate_run(run_with_poses(0, 99, 0.003), kOnMap).behaviour.within_bound, Optional(0.0));
}

TEST(Judge, ComparesTrustWithErrors) {
  RunResult run = run_with_poses(0, 99, 0.01);
  for (const int far : {30, 31, 60}) run.causal[far].world_from_body.translation.x() += 0.3;
  run.frames[60].report->health.verdict = Verdict::degraded;
  const BehaviourMeasures behaviour = evaluate_run(run, kOnMap).behaviour;
  EXPECT_THAT(behaviour.wrongly_trusted, Optional(2.0));
  EXPECT_THAT(behaviour.trusted_map_error_max, Optional(DoubleNear(std::hypot(0.3, kOffset), 1e-9)));
  EXPECT_THAT(behaviour.trusted_share, Optional(DoubleNear(0.99, 1e-12)));
  EXPECT_THAT(behaviour.longest_wrong_trust, Optional(DoubleNear(to_seconds(kInterval), 1e-9)));
}

TEST(Judge, CountsLossesKeyframesAndTimes) {
  RunResult run = run_with_poses(0, 99, 0.01);
  run.frames[10].report->events = {SessionEvent::pose_lost};
  run.frames[40].report->events = {SessionEvent::relocalised};
  for (const int keyframe : {0, 15, 50}) run.frames[keyframe].report->keyframe_added = true;
  run.frames[99].seconds.total = 0.11;
  const RunMeasures measures = evaluate_run(run, kOnMap);
  EXPECT_THAT(measures.behaviour.losses, Optional(1.0));
  EXPECT_THAT(measures.behaviour.keyframes, Optional(3.0));
  EXPECT_THAT(measures.cost.frame_ms_mean, Optional(DoubleNear(11.0, 1e-9)));
  EXPECT_GT(*measures.cost.frame_ms_p99, 10.0);
}

TEST(Judge, SeparatesKeyframesInKnownPlacesFromOthers) {
  RunResult run = run_with_poses(0, 99, 0.01);
  for (int i = 1; i <= 60; ++i) run.frames[i].report->health.offline_inliers = 1000;
  for (const int keyframe : {30, 70, 80}) run.frames[keyframe].report->keyframe_added = true;
  const BehaviourMeasures on_map = evaluate_run(run, kOnMap).behaviour;
  EXPECT_THAT(on_map.keyframe_rate_mapped, Optional(DoubleNear(60.0 / 3.0, 1e-9))) << "one in 3 s";
  EXPECT_THAT(on_map.keyframe_rate_unmapped, Optional(DoubleNear(2.0 * 60.0 / 1.95, 1e-9))) << "two in 39 intervals";
  EXPECT_FALSE(evaluate_run(run, kWithoutMap).behaviour.keyframe_rate_mapped) << "no known places without a map";
}

TEST(Trace, IsInTheFrameOfTheTruth) {
  const RunResult run = run_with_poses(0, 99, 0.01);
  const std::vector<TracePoint> on_map = trace_of(run.final, kOnMap);
  ASSERT_THAT(on_map, SizeIs(kFrames));
  EXPECT_THAT(on_map, Each(Field(&TracePoint::error, DoubleNear(kOffset, 1e-9))));
  EXPECT_THAT(on_map[7].position_in_truth.x(), DoubleNear(true_pose(7).translation.x(), 1e-9));
  EXPECT_THAT(trace_of(run.final, kWithoutMap), Each(Field(&TracePoint::error, DoubleNear(0.0, 1e-9)))) << "aligned";
  EXPECT_THAT(trace_of({}, kWithoutMap), SizeIs(0));
}

}  // namespace
}  // namespace byre
