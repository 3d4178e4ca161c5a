// Sessions with motion measured by wheels or a gyroscope.

#include "byre/slam/session/session_scene.h"
#include "byre/trajectory_error.h"

#include <algorithm>

#include <gtest/gtest.h>

namespace byre {
namespace {

constexpr std::size_t kDark = 20;   // number of the first frame without features
constexpr std::size_t kLight = 30;  // number of the first frame with features again

SimulatedMission lap() {
  SimulationOptions options;
  options.pixel_sigma = 0.2;
  options.disparity_sigma = 0.1;
  return simulate_mission(simulated_rig(robot_from_camera()),
                          circling_trajectory(80, 10.0, 2.0, 1.0, robot_from_camera()), options);
}

Frame dark(const Frame& frame, const Rig& rig) {
  Frame result = frame;
  result.features = std::make_shared<const Features>(rig.width, rig.height, std::vector<Keypoint>{},
                                                     std::vector<Descriptor>{}, std::vector<Patch>{});
  return result;
}

// Reports of a robot without features for an eighth of a lap.
std::vector<FrameReport> fly(Session& session, const SimulatedMission& mission, bool has_odometry) {
  std::vector<FrameReport> reports;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    std::optional<BodyMotion> motion;
    if (has_odometry && i > 0)
      motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
    const bool is_dark = i >= kDark && i < kLight;
    reports.push_back(session.process(is_dark ? dark(mission.frames[i], mission.rig) : mission.frames[i], motion));
  }
  return reports;
}

// Same drive without relocalisation.
std::vector<FrameReport> reports_of(const SimulatedMission& mission, bool has_odometry, bool has_vocabulary) {
  SessionOptions options;
  options.min_kept_share = 0.0;  // no fallback if the prediction is wrong
  options.relocalise.min_inliers = 1000000;
  Session session(mission.rig, options, SessionExecutors(make_inline_executor()),
                  has_vocabulary ? std::optional(simulated_vocabulary()) : std::nullopt);
  return fly(session, mission, has_odometry);
}

double error_of(const FrameReport& report, const SimulatedMission& mission, std::size_t frame) {
  const Pose truth = inverse(mission.truth.front().world_from_body) * mission.truth[frame].world_from_body;
  return (report.map_from_body->translation - truth.translation).norm();
}

TEST(MeasuredMotion, RelocalisesAfterTheDark) {
  const SimulatedMission mission = lap();
  for (const bool has_vocabulary : {true, false}) {
    const std::vector<FrameReport> odometry = reports_of(mission, true, has_vocabulary);
    const std::vector<FrameReport> untold = reports_of(mission, false, has_vocabulary);
    ASSERT_TRUE(odometry[kLight].map_from_body);
    EXPECT_NE(odometry[kLight].health.doubt, DistrustReason::bridged);
    EXPECT_LT(error_of(odometry[kLight], mission, kLight), 0.05);
    EXPECT_FALSE(untold[kLight].map_from_body && error_of(untold[kLight], mission, kLight) < 0.05);
  }
}

TEST(MeasuredMotion, PropagatesInTheDarkWithGrowingCovariance) {
  const SimulatedMission mission = lap();
  const std::vector<FrameReport> odometry = reports_of(mission, true, true);
  const std::vector<FrameReport> untold = reports_of(mission, false, true);
  double sigma = odometry[kDark - 1].health.position_sigma;
  for (std::size_t i = kDark; i < kLight; ++i) {
    ASSERT_TRUE(odometry[i].map_from_body && odometry[i].odometry_from_body) << i;
    EXPECT_FALSE(untold[i].map_from_body) << i;
    EXPECT_LT(error_of(odometry[i], mission, i), 0.02) << i;
    EXPECT_EQ(odometry[i].health.doubt, DistrustReason::bridged) << i;
    EXPECT_NE(odometry[i].health.verdict, Verdict::trusted) << i;
    EXPECT_GT(odometry[i].health.position_sigma, sigma) << i;
    sigma = odometry[i].health.position_sigma;
  }
}

TEST(MeasuredMotion, KeepsBridgedPosesInTheTrajectory) {
  const SimulatedMission mission = lap();
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  fly(session, mission, true);
  session.finish();
  EXPECT_EQ(session.final_trajectory().size(), mission.frames.size());
}

TEST(MeasuredMotion, BridgesWhileTheTrajectoryIsThinned) {
  const SimulatedMission mission = lap();
  SessionOptions options;
  options.trajectory.max_poses = 16;
  Session session(mission.rig, options, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  fly(session, mission, true);
  session.finish();
  const Trajectory kept = session.final_trajectory();
  EXPECT_LE(kept.size(), options.trajectory.max_poses);
  for (const StampedPose& pose : kept) {
    const auto truth = std::ranges::find(mission.truth, pose.time, &StampedPose::time);
    ASSERT_NE(truth, mission.truth.end());
    const Pose expected = inverse(mission.truth.front().world_from_body) * truth->world_from_body;
    EXPECT_LT((pose.world_from_body.translation - expected.translation).norm(), 0.05);
  }
}

TEST(MeasuredMotion, EndsABridgeAtAGap) {
  const SimulatedMission mission = lap();
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  for (std::size_t i = 0; i < kLight; ++i) {
    std::optional<BodyMotion> motion;
    if (i > 0 && i != kDark + 4) {
      motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
    }
    const FrameReport report =
        session.process(i >= kDark ? dark(mission.frames[i], mission.rig) : mission.frames[i], motion);
    EXPECT_EQ(report.map_from_body.has_value(), i < kDark + 4) << i;
  }
}

// The robot moves on, so that nothing of the map is recognised after the dark.
TEST(MeasuredMotion, JoinsANewSubmapToTheMap) {
  const SimulatedMission mission = lap();
  constexpr std::size_t kLongDark = 30;  // frames
  SessionOptions options;
  options.relocalise.min_inliers = 1000000;
  options.min_kept_share = 0.0;
  for (const bool has_odometry : {true, false}) {
    Session session(mission.rig, options, SessionExecutors(make_inline_executor()), simulated_vocabulary());
    FrameReport report;
    for (std::size_t i = 0; i < mission.frames.size(); ++i) {
      std::optional<BodyMotion> motion;
      if (has_odometry && i > 0)
        motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
      const bool is_dark = i >= kDark && i < kDark + kLongDark;
      report = session.process(is_dark ? dark(mission.frames[i], mission.rig) : mission.frames[i], motion);
    }
    const bool is_joined = report.map_from_body && report.health.doubt != DistrustReason::bridged &&
                           error_of(report, mission, mission.frames.size() - 1) < 0.1;
    EXPECT_EQ(is_joined, has_odometry);
  }
}

TEST(MeasuredMotion, RejectsAPlaceBeyondTheReachOfWheels) {
  const SimulatedMission mission = lap();
  for (const bool has_odometry : {true, false}) {
    Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
    if (has_odometry) session.set_odometry({}, [](Timestamp, Timestamp) { return std::optional(0.5); });
    for (std::size_t i = 0; i < kDark; ++i) EXPECT_TRUE(session.process(mission.frames[i]).map_from_body) << i;
    Frame elsewhere = mission.frames[2];
    elsewhere.time = mission.frames[kDark].time;
    EXPECT_EQ(session.process(elsewhere).map_from_body.has_value(), !has_odometry);
    EXPECT_TRUE(session.process(mission.frames[kDark + 1]).map_from_body);
  }
}

// Scale of the map by the frames so far, metres per unit.
double metres_per_unit(const std::vector<FrameReport>& reports, const SimulatedMission& mission) {
  double seen = 0.0, true_way = 0.0;
  for (std::size_t i = 1; i < reports.size(); ++i) {
    if (!reports[i - 1].map_from_body || !reports[i].map_from_body ||
        reports[i].health.doubt == DistrustReason::bridged)
      continue;
    seen += (inverse(*reports[i - 1].map_from_body) * *reports[i].map_from_body).translation.norm();
    true_way +=
        (mission.truth[i].world_from_body.translation - mission.truth[i - 1].world_from_body.translation).norm();
  }
  return seen > 0.0 ? true_way / seen : 1.0;
}

SimulatedMission one_camera_circling(int frames, double laps) {
  Rig rig = simulated_rig();
  rig.baseline = 0.0;
  SimulationOptions visit;
  visit.landmarks = 8000;
  return simulate_mission(rig, circling_trajectory(frames, 10.0, 2.0, laps), visit);
}

// One camera that recognises nothing after the dark: the scale of its new submap is that of the measured motion.
TEST(MeasuredMotion, StartsANewMonocularSubmap) {
  const SimulatedMission mission = one_camera_circling(120, 1.0);
  const Rig& rig = mission.rig;
  constexpr std::size_t kFirstDark = 60, kFirstLight = 80;
  SessionOptions options;
  options.relocalise.min_inliers = 1000000;
  options.min_kept_share = 0.0;
  Session session(rig, options, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  std::vector<FrameReport> reports;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    std::optional<BodyMotion> motion;
    if (i > 40) {
      Pose pose = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
      pose.translation /= metres_per_unit(reports, mission);
      motion = pose;
    }
    const bool is_dark = i >= kFirstDark && i < kFirstLight;
    reports.push_back(session.process(is_dark ? dark(mission.frames[i], rig) : mission.frames[i], motion));
  }
  EXPECT_TRUE(std::ranges::any_of(reports, [](const FrameReport& r) { return r.has(SessionEvent::restarted); }));
  EXPECT_NE(reports.back().health.doubt, DistrustReason::bridged);
  session.finish();
  const auto error = absolute_trajectory_error(associate(session.final_trajectory(), mission.truth, {}), Scale::free);
  ASSERT_TRUE(error);
  EXPECT_GT(session.final_trajectory().size(), 90u);
  EXPECT_LT(error->translation.rmse, 0.05);
}

// One camera begins its map after about a second; wheels have measured its motion since the first frame.
TEST(MeasuredMotion, PropagatesOneCameraUntilItsMapStarts) {
  const SimulatedMission mission = one_camera_circling(60, 0.5);
  const Rig& rig = mission.rig;
  for (const bool has_odometry : {true, false}) {
    Session session(rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
    std::vector<FrameReport> reports;
    for (std::size_t i = 0; i < mission.frames.size(); ++i) {
      std::optional<BodyMotion> motion;
      if (has_odometry && i > 0)
        motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
      reports.push_back(session.process(mission.frames[i], motion));
    }
    const auto begun = std::ranges::find_if(reports, [](const auto& r) { return r.has(SessionEvent::initialised); });
    ASSERT_NE(begun, reports.end());
    ASSERT_GT(begun - reports.begin(), 3);
    for (std::size_t i = 1; i < reports.size(); ++i) {
      const bool is_before = i < static_cast<std::size_t>(begun - reports.begin());
      EXPECT_EQ(reports[i].map_from_body.has_value(), has_odometry || !is_before) << i;
      EXPECT_EQ(reports[i].health.doubt == DistrustReason::bridged, has_odometry && is_before) << i;
      EXPECT_EQ(reports[i].state == State::initialising, is_before) << i;
      if (!has_odometry) continue;
      EXPECT_LT(error_of(reports[i], mission, i), 0.05) << i << ", in metres from the first frame on";
    }
  }
}

// A gap in the measured motion makes the pose relative to the first frame unknown.
TEST(MeasuredMotion, DoesNotPropagateAcrossAGapBeforeTheMapStarts) {
  const SimulatedMission mission = lap();
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  constexpr std::size_t kUntold = 5, kSeen = 8;
  for (std::size_t i = 0; i <= kSeen; ++i) {
    std::optional<BodyMotion> motion;
    if (i > 0 && i != kUntold) {
      motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
    }
    const bool is_dark = i < kSeen;
    const FrameReport report =
        session.process(is_dark ? dark(mission.frames[i], mission.rig) : mission.frames[i], motion);
    EXPECT_EQ(report.map_from_body.has_value(), (i > 0 && i < kUntold) || i == kSeen) << i;
    if (!is_dark) {
      EXPECT_LT(report.map_from_body->translation.norm(), 1e-9) << "the map starts at this pose";
    }
  }
}

TEST(MeasuredMotion, StartsAStereoMapAfterADarkStart) {
  const SimulatedMission mission = lap();
  Session session(mission.rig, {}, SessionExecutors(make_inline_executor()), simulated_vocabulary());
  constexpr std::size_t kSeen = 8;
  for (std::size_t i = 0; i < kSeen + 5; ++i) {
    std::optional<BodyMotion> motion;
    if (i > 0) motion = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
    const bool is_dark = i < kSeen;
    const FrameReport report =
        session.process(is_dark ? dark(mission.frames[i], mission.rig) : mission.frames[i], motion);
    ASSERT_EQ(report.map_from_body.has_value(), i > 0) << i;
    if (i == 0) continue;
    EXPECT_LT(error_of(report, mission, i), 0.02) << i;
    EXPECT_TRUE(is_dark || report.health.position_sigma < 0.05) << "the first pose defines the map frame";
  }
}

// A measured motion with an error of metres from frame 20 on, while points are visible.
TEST(MeasuredMotion, KeepsATrackedPoseDespiteWrongMotion) {
  const SimulatedMission mission = lap();
  for (const bool has_vocabulary : {true, false}) {
    for (const double metres : {-2.7, 1.0, 30.0}) {
      Session session(mission.rig, {}, SessionExecutors(make_inline_executor()),
                      has_vocabulary ? std::optional(simulated_vocabulary()) : std::nullopt);
      for (std::size_t i = 0; i < mission.frames.size(); ++i) {
        std::optional<BodyMotion> motion;
        if (i > 0) {
          Pose step = inverse(mission.truth[i - 1].world_from_body) * mission.truth[i].world_from_body;
          if (i >= kDark) step.translation.x() += metres;
          motion = step;
        }
        const FrameReport report = session.process(mission.frames[i], motion);
        ASSERT_TRUE(report.map_from_body) << i << " " << metres;
        EXPECT_FALSE(report.has(SessionEvent::pose_lost)) << i << " " << metres;
        EXPECT_NE(report.health.doubt, DistrustReason::bridged) << i << " " << metres;
        EXPECT_LT(error_of(report, mission, i), 0.05) << i << " " << metres;
      }
    }
  }
}

// After a dark stretch the odometry keeps the uncertainty of the measured motion.
TEST(MeasuredMotion, KeepsItsUncertaintyInTheOdometryAfterTheDark) {
  const SimulatedMission mission = lap();
  const std::vector<FrameReport> odometry = reports_of(mission, true, true);
  const auto variance = [&](std::size_t i) { return position_variance(odometry[i].odometry_covariance); };
  EXPECT_GT(variance(kLight), 0.5 * variance(kLight - 1));
  EXPECT_GT(variance(kLight + 5), 0.5 * variance(kLight - 1));
}

}  // namespace
}  // namespace byre
