// Tracking and mapping together on simulated missions.

#include "byre/slam/session/session.h"

#include "byre/base/sanitizer_scene.h"
#include "byre/geometry/degrees.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/slam/session/session_scene.h"
#include "byre/slam/tracking/mission_scene.h"
#include "byre/trajectory_error.h"

#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Each;
using ::testing::Field;
using ::testing::IsEmpty;
using ::testing::SizeIs;

constexpr double kMaxError = 0.05;  // metres, root mean square over a mission of 10 m or a full turn

// Results of a mission.
struct Outcome {
  std::vector<FrameReport> reports;
  Trajectory causal;
  Trajectory final;
  MapGraph map{Origin::online};
};

Trajectory causal_trajectory(const std::vector<FrameReport>& reports) {
  Trajectory trajectory;
  for (const FrameReport& report : reports) {
    if (report.map_from_body) trajectory.push_back({report.time, *report.map_from_body});
  }
  return trajectory;
}

Outcome run(const Rig& rig, const std::vector<Frame>& frames, std::unique_ptr<Executor> executor) {
  Session session(rig, {}, std::move(executor));
  Outcome result;
  for (const Frame& frame : frames) result.reports.push_back(session.process(frame));
  session.finish();
  result.causal = causal_trajectory(result.reports);
  result.final = session.final_trajectory();
  result.map = session.map().online();
  return result;
}

Outcome run(const SimulatedMission& mission) {
  return run(mission.rig, mission.frames, make_inline_executor());
}

SimulatedMission circling_robot(int frames = 120, const SimulationOptions& options = {}) {
  return simulate_mission(simulated_rig(robot_from_camera()),
                          circling_trajectory(frames, 15.0, 2.0, frames / 120.0, robot_from_camera()), options);
}

SimulatedMission turning(int frames = 100) {
  return simulate_mission(simulated_rig(robot_from_camera()),
                          turning_in_place_trajectory(frames, 15.0, 1.0, robot_from_camera()), {});
}

SimulatedMission figure_eight() {
  return simulate_mission(simulated_rig(robot_from_camera()),
                          figure_eight_trajectory(150, 15.0, 4.0, 1.0, robot_from_camera()), {});
}

// Errors with the first poses aligned: alignment of positions would not measure the heading of a camera that turns in
// place.
AbsoluteTrajectoryError error_of(const Trajectory& estimate, const Trajectory& truth) {
  const Pose& start = truth.front().world_from_body;
  return absolute_trajectory_error(associate(estimate, truth, {}), {1.0, {start.rotation, start.translation}});
}

struct NamedMission {
  const char* name;
  SimulatedMission (*make)();
};

// Each mission runs once; the tests only read it.
class EveryMission : public ::testing::TestWithParam<NamedMission> {
 protected:
  struct Finished {
    SimulatedMission mission;
    Outcome outcome;
  };
  static const Finished& finished() {
    static std::map<std::string, Finished> missions;
    const auto [entry, is_new] = missions.try_emplace(GetParam().name);
    if (is_new) {
      entry->second.mission = GetParam().make();
      entry->second.outcome = run(entry->second.mission);
    }
    return entry->second;
  }
};

TEST_P(EveryMission, HasAPoseForEveryFrame) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto& [mission, outcome] = finished();
  EXPECT_THAT(outcome.reports, Each(Field(&FrameReport::state, State::tracking)));
  EXPECT_THAT(outcome.causal, SizeIs(mission.frames.size()));
  EXPECT_THAT(outcome.final, SizeIs(mission.frames.size()));
}

TEST_P(EveryMission, StaysNearTheTruth) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto& [mission, outcome] = finished();
  const AbsoluteTrajectoryError causal = error_of(outcome.causal, mission.truth);
  const AbsoluteTrajectoryError final = error_of(outcome.final, mission.truth);
  RecordProperty("causal_rmse_mm", std::to_string(1e3 * causal.translation.rmse));
  RecordProperty("final_rmse_mm", std::to_string(1e3 * final.translation.rmse));
  EXPECT_LT(causal.translation.rmse, kMaxError);
  EXPECT_LT(final.translation.rmse, kMaxError);
  EXPECT_LT(causal.rotation.rmse, 1.0);
  EXPECT_LT(final.rotation.rmse, 1.0);
}

TEST_P(EveryMission, ReturnsAValidMap) {
  if (kHasThreadSanitizer) GTEST_SKIP() << kSlowUnderThreadSanitizer;
  const auto& [mission, outcome] = finished();
  EXPECT_THAT(find_faults(outcome.map), IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(On, EveryMission,
                         ::testing::Values(NamedMission{"Circling", [] { return circling_robot(); }},
                                           NamedMission{"TurningInPlace", [] { return turning(); }},
                                           NamedMission{"FigureEight", [] { return figure_eight(); }}),
                         [](const auto& tested) { return tested.param.name; });

TEST(Session, UsesTheFirstBodyFrameAsWorld) {
  const SimulatedMission mission = circling_robot(2);
  Session session(mission.rig, {}, make_inline_executor());
  EXPECT_THAT(session.process(mission.frames[0]).map_from_body.value(), PoseNear(Pose{}, 1e-12, 1e-7));
}

TEST(Session, ToleratesOutliers) {
  SimulationOptions options;
  options.outlier_ratio = 0.2;
  const SimulatedMission mission = circling_robot(60, options);
  const Outcome result = run(mission);
  EXPECT_THAT(result.causal, SizeIs(mission.frames.size()));
  EXPECT_LT(error_of(result.causal, mission.truth).translation.rmse, kMaxError);
}

// --- executors

void expect_identical(const Trajectory& first, const Trajectory& second) {
  ASSERT_EQ(first.size(), second.size());
  for (std::size_t i = 0; i < first.size(); ++i) {
    EXPECT_EQ(first[i].time, second[i].time);
    EXPECT_EQ(first[i].world_from_body.translation, second[i].world_from_body.translation);
    EXPECT_EQ(first[i].world_from_body.rotation.coeffs(), second[i].world_from_body.rotation.coeffs());
  }
}

void expect_identical(const Outcome& first, const Outcome& second) {
  expect_identical(first.causal, second.causal);
  expect_identical(first.final, second.final);
  ASSERT_EQ(first.map.keyframe_ids(), second.map.keyframe_ids());
  ASSERT_EQ(first.map.point_ids(), second.map.point_ids());
  for (const PointId id : first.map.point_ids()) {
    EXPECT_EQ(first.map.find_point(id)->position_in_world, second.map.find_point(id)->position_in_world);
    EXPECT_EQ(first.map.observations(id), second.map.observations(id));
  }
}

TEST(Session, IsDeterministicInline) {
  const SimulatedMission mission = circling_robot(60);
  expect_identical(run(mission), run(mission));
}

TEST(Session, IsDeterministicPaced) {
  const SimulatedMission mission = circling_robot(60);
  expect_identical(run(mission.rig, mission.frames, make_paced_executor(3)),
                   run(mission.rig, mission.frames, make_paced_executor(3)));
}

TEST(Session, StaysNearTheTruthWithConcurrentMapping) {
  const SimulatedMission mission = circling_robot(60);
  for (const auto make : {+[] { return make_paced_executor(3); }, +[] { return make_live_executor(); }}) {
    const Outcome result = run(mission.rig, mission.frames, make());
    EXPECT_THAT(result.causal, SizeIs(mission.frames.size()));
    EXPECT_LT(error_of(result.causal, mission.truth).translation.rmse, kMaxError);
    EXPECT_LT(error_of(result.final, mission.truth).translation.rmse, kMaxError);
    EXPECT_THAT(find_faults(result.map), IsEmpty());
  }
}

// Returns the deltas of the test in place of mapping results, at the times that the test chooses.
class ScriptedExecutor final : public Executor {
 public:
  using Mapping = std::function<MapDelta()>;

  explicit ScriptedExecutor(Mapping& due) : due_(due) {}
  void submit(Job) override { idle_ = false; }
  std::optional<FinishedJob> collect() override {
    if (idle_ || !due_) return std::nullopt;
    idle_ = true;
    return FinishedJob{LocalOutcome{std::exchange(due_, nullptr)()}, 0.0};
  }
  std::optional<FinishedJob> finish() override { return collect(); }
  bool idle() const override { return idle_; }

 private:
  Mapping& due_;
  bool idle_ = true;
};

// A camera that turns by 3.6 degrees per frame, in a session that seldom adds a keyframe.
class SessionWithScriptedMapping : public ::testing::Test {
 protected:
  static SessionOptions options() {
    SessionOptions options;
    options.keyframes.min_tracked_share = 0.0;
    options.keyframes.min_tracked = 0;
    options.keyframes.max_turn = 27.0 * kDegree;
    return options;
  }

  // Processes the frame of any place of the mission at the next frame time.
  FrameReport process(std::size_t place) {
    Frame frame = mission_.frames[place];
    frame.time = mission_.frames[processed_++].time;
    return session_.process(frame);
  }
  const MapGraph& map() const { return session_.map().online(); }
  Pose true_world_from_body(std::size_t place) const {
    return inverse(mission_.truth[0].world_from_body) * mission_.truth[place].world_from_body;
  }

  const SimulatedMission mission_ = turning();
  ScriptedExecutor::Mapping due_;
  Session session_{mission_.rig, options(), std::unique_ptr<Executor>(std::make_unique<ScriptedExecutor>(due_))};

 private:
  std::size_t processed_ = 0;
};

TEST_F(SessionWithScriptedMapping, TracksOnWhenMappingRemovesItsReference) {
  for (std::size_t place = 0; place <= 16; ++place) process(place);
  ASSERT_THAT(map().keyframe_ids(), SizeIs(3));
  for (std::size_t place = 15; place >= 9; --place) process(place);  // back to the second keyframe
  ASSERT_THAT(map().keyframe_ids(), SizeIs(3));
  due_ = [] {
    MapDelta delta;
    delta.removed_keyframes.push_back({1});
    return delta;
  };
  for (std::size_t place = 10; place <= 16; ++place) {
    const FrameReport report = process(place);
    ASSERT_EQ(report.state, State::tracking);
    EXPECT_THAT(report.map_from_body.value(), PoseNear(true_world_from_body(place), 0.05, kDegree));
  }
  EXPECT_THAT(map().keyframe_ids(), SizeIs(2));
}

TEST_F(SessionWithScriptedMapping, PassesAnExceptionOfMappingToTheCaller) {
  for (std::size_t place = 0; place <= 10; ++place) process(place);
  due_ = []() -> MapDelta { throw std::runtime_error("broken job"); };
  EXPECT_THROW(process(11), std::runtime_error);
}

// The delta of a loop closing: moves the whole map by far more than a frame's search radius.
TEST_F(SessionWithScriptedMapping, FollowsMapCorrections) {
  for (std::size_t place = 0; place <= 10; ++place) process(place);
  const Pose new_world_from_world{rotation_exp({0.0, 0.0, 0.3}), {1.0, 0.5, 0.0}};
  due_ = [&] {
    MapDelta delta;
    for (const KeyframeId id : map().keyframe_ids()) {
      const Keyframe& keyframe = *map().find_keyframe(id);
      delta.moved_keyframes.push_back(
          {{id.number}, keyframe.camera_from_world * inverse(new_world_from_world), keyframe.covariance});
    }
    for (const PointId id : map().point_ids()) {
      MapPoint point = *map().find_point(id);
      point.position_in_world = new_world_from_world * point.position_in_world;
      point.mean_viewing_direction = new_world_from_world.rotation.cast<float>() * point.mean_viewing_direction;
      delta.updated_points.push_back({{id.number}, point});
    }
    return delta;
  };
  const FrameReport report = process(11);
  ASSERT_EQ(report.state, State::tracking);
  EXPECT_THAT(report.map_from_body.value(), PoseNear(new_world_from_world * true_world_from_body(11), 0.05, kDegree));
  EXPECT_THAT(session_.final_trajectory()[5].world_from_body,
              PoseNear(new_world_from_world * true_world_from_body(5), 0.05, kDegree));
}

// --- begin and end of tracking

class SessionOnACircle : public ::testing::Test {
 protected:
  State process(std::size_t frame) { return session_.process(mission_.frames[frame]).state; }
  FrameReport blind(std::size_t frame) { return session_.process(without_features(mission_.frames[frame])); }

  const SimulatedMission mission_ = circling_robot(40);
  Session session_{mission_.rig, {}, make_inline_executor()};
};

TEST_F(SessionOnACircle, IsLostWithoutFeaturesAndRelocalises) {
  for (std::size_t i = 0; i < 15; ++i) ASSERT_EQ(process(i), State::tracking);
  for (std::size_t i = 15; i < 20; ++i) {
    const FrameReport report = blind(i);
    EXPECT_EQ(report.state, State::relocalising);
    EXPECT_EQ(report.map_from_body, std::nullopt);
  }
  for (std::size_t i = 20; i < 40; ++i) EXPECT_EQ(process(i), State::tracking);
  EXPECT_THAT(session_.final_trajectory(), SizeIs(35));
  EXPECT_LT(error_of(session_.final_trajectory(), mission_.truth).translation.rmse, kMaxError);
}

TEST_F(SessionOnACircle, InitialisesWithTheFirstStereoFrame) {
  EXPECT_EQ(blind(0).state, State::initialising);
  EXPECT_EQ(blind(1).map_from_body, std::nullopt);
  EXPECT_EQ(process(2), State::tracking);
  EXPECT_EQ(process(3), State::tracking);
}

TEST_F(SessionOnACircle, NeverInitialisesWithoutDisparities) {
  Rig mono = mission_.rig;
  mono.baseline = 0.0;
  const SimulatedMission mono_mission = simulate_mission(mono, mission_.truth, {});
  for (const Frame& frame : mono_mission.frames) {
    const FrameReport report = session_.process(frame);
    EXPECT_EQ(report.state, State::initialising);
    EXPECT_EQ(report.map_from_body, std::nullopt);
  }
  EXPECT_THAT(session_.final_trajectory(), IsEmpty());
}

TEST_F(SessionOnACircle, HasNoPoseAfterAKidnapping) {
  SimulationOptions another_room;
  another_room.seed = 99;
  const SimulatedMission elsewhere = circling_robot(40, another_room);
  for (std::size_t i = 0; i < 10; ++i) ASSERT_EQ(process(i), State::tracking);
  for (std::size_t i = 10; i < 40; ++i) {
    const FrameReport report = session_.process(elsewhere.frames[i]);
    EXPECT_EQ(report.state, State::relocalising);
    EXPECT_EQ(report.map_from_body, std::nullopt);
  }
  EXPECT_THAT(session_.final_trajectory(), SizeIs(10));
}

TEST(Session, AddsNothingWhileMappingIsPausedAndContinuesAfterwards) {
  const SimulatedMission mission = circling_robot();
  Session session(mission.rig, {}, make_inline_executor());
  std::vector<int> keyframes;
  for (std::size_t i = 0; i < mission.frames.size(); ++i) {
    if (i == 40) session.pause_mapping(true);
    if (i == 50) session.pause_mapping(false);
    EXPECT_TRUE(session.process(mission.frames[i]).map_from_body) << i;
    keyframes.push_back(session.map().online().keyframe_count());
  }
  EXPECT_GT(keyframes[39], 3) << "the path requires keyframes";
  EXPECT_EQ(keyframes[49], keyframes[39]);
  EXPECT_GT(keyframes[51], keyframes[39]);
}

TEST(Session, StartsNoMapWhileMappingIsPaused) {
  const SimulatedMission mission = circling_robot(10);
  Session session(mission.rig, {}, make_inline_executor());
  session.pause_mapping(true);
  EXPECT_EQ(session.process(mission.frames[0]).state, State::initialising);
  session.pause_mapping(false);
  EXPECT_EQ(session.process(mission.frames[1]).state, State::tracking);
}

TEST(Session, FinishesWithoutAnyFrame) {
  Session session(simulated_rig(), {}, make_paced_executor(2));
  session.finish();
  EXPECT_THAT(session.final_trajectory(), IsEmpty());
}

TEST(Session, AppliesRemainingMappingResultsAtTheEnd) {
  const SimulatedMission mission = circling_robot(30);
  Session session(mission.rig, {}, make_paced_executor(1000));  // longer than the mission
  for (const Frame& frame : mission.frames) session.process(frame);
  const std::size_t before = session.map().online().point_ids().size();
  session.finish();
  EXPECT_NE(session.map().online().point_ids().size(), before);
  EXPECT_THAT(find_faults(session.map().online()), IsEmpty());
}

}  // namespace
}  // namespace byre
