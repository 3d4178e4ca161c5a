// Whole frames of the method as a function of state and measurements, without threads and files.

#include "byre/slam/session/step.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_file.h"
#include "byre/slam/session/session_scene.h"
#include "byre/slam/window/online_copy.h"

#include <functional>
#include <string>

#include <gmock/gmock.h>

namespace byre {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Not;

const SimulatedMission& mission() {
  static const SimulatedMission simulated = quarter_circle({});
  return simulated;
}

// Processes a frame, and runs its jobs.
FrameReport process(RobotState& state, const StepInput& input) {
  Step now = step(state, input, {});
  for (const JobRequest& request : now.jobs) deliver(request.kind, {request.job(), 0.0}, state);
  return now.report;
}

// State after the first frames of the mission.
RobotState after(std::size_t frames, std::shared_ptr<const OfflineMap> offline = nullptr) {
  RobotState state(mission().rig, {}, simulated_vocabulary(), std::move(offline));
  for (std::size_t i = 0; i < frames; ++i) process(state, {mission().frames[i]});
  return state;
}

std::vector<JobKind> kinds_of(const std::vector<JobRequest>& jobs) {
  std::vector<JobKind> kinds;
  for (const JobRequest& job : jobs) kinds.push_back(job.kind);
  return kinds;
}

// A frame given to the state after some frames of a mission.
struct Case {
  std::string name;
  bool is_on_map = false;
  std::size_t frames_before = 0;
  std::function<Frame()> frame;
  State state = State::initialising;
  bool has_map_pose = false;
  std::optional<SessionEvent> event{};  // among others
};

class StepOf : public ::testing::TestWithParam<Case> {};

TEST_P(StepOf, AFrameLeadsToItsStateAndReport) {
  const Case& given = GetParam();
  RobotState state = after(given.frames_before, given.is_on_map ? offline_map_of(mission()) : nullptr);
  const FrameReport report = step(state, {given.frame()}, {}).report;
  EXPECT_EQ(report.state, given.state);
  EXPECT_EQ(report.map_from_body.has_value(), given.has_map_pose);
  if (given.event) {
    EXPECT_THAT(report.events, Contains(*given.event));
  }
}

Frame whole(std::size_t number) {
  return mission().frames[number];
}
Frame blank(std::size_t number) {
  return without_features(whole(number));
}

INSTANTIATE_TEST_SUITE_P(
    EachKind, StepOf,
    ::testing::Values(
        Case{"TheFirstOne", false, 0, [] { return whole(0); }, State::tracking, true, SessionEvent::initialised},
        Case{"ABlankFirstOne", false, 0, [] { return blank(0); }, State::initialising, false},
        Case{"ATrackedOne", false, 5, [] { return whole(5); }, State::tracking, true},
        Case{"ABlankOne", false, 5, [] { return blank(5); }, State::relocalising, false, SessionEvent::pose_lost},
        Case{"TheFirstOneOnAMap", true, 0, [] { return whole(0); }, State::relocalising, true},
        Case{"ATrackedOneOnAMap", true, 10, [] { return whole(10); }, State::tracking, true},
        Case{"ABlankOneOnAMap", true, 10, [] { return blank(10); }, State::relocalising, false,
             SessionEvent::pose_lost}),
    [](const auto& tested) { return tested.param.name; });

TEST(Step, LocalisesTheFrameAtItsTruePose) {
  RobotState state = after(5);
  const FrameReport report = step(state, {whole(5)}, {}).report;
  const Pose true_pose = inverse(mission().truth[0].world_from_body) * mission().truth[5].world_from_body;
  ASSERT_TRUE(report.map_from_body);
  EXPECT_THAT(*report.map_from_body, PoseNear(true_pose, 0.02, 0.01));
}

TEST(Step, RequestsMappingAndAnIndexForANewKeyframe) {
  RobotState state = after(1);
  for (std::size_t i = 1; i < mission().frames.size(); ++i) {
    const Step now = step(state, {whole(i)}, {});
    if (!now.report.keyframe_added) {
      EXPECT_THAT(now.jobs, IsEmpty()) << "frame " << i;
      continue;
    }
    EXPECT_THAT(kinds_of(now.jobs), ElementsAre(JobKind::local, JobKind::index));
    return;
  }
  FAIL() << "no keyframe";
}

TEST(Step, AppliesTheResultOfAJobToALaterFrame) {
  RobotState state = after(1);
  std::size_t frame = 1;
  Step now = step(state, {whole(frame)}, {});
  while (!now.report.keyframe_added) now = step(state, {whole(++frame)}, {});
  EXPECT_FALSE(step(state, {whole(++frame)}, {}).report.job_seconds) << "the job is in flight";
  for (const JobRequest& request : now.jobs) deliver(request.kind, {request.job(), 0.25}, state);
  EXPECT_EQ(step(state, {whole(++frame)}, {}).report.job_seconds, 0.25);
}

// A mission differs from mapping by the presence of the offline map.
TEST(Step, SearchesThePlaceInParallelOnAMap) {
  RobotState state(mission().rig, {}, simulated_vocabulary(), offline_map_of(mission()));
  std::vector<JobKind> requested;
  for (std::size_t i = 0; i < 10; ++i) {
    const Step now = step(state, {whole(i)}, {});
    for (const JobKind kind : kinds_of(now.jobs)) requested.push_back(kind);
    for (const JobRequest& request : now.jobs) deliver(request.kind, {request.job(), 0.0}, state);
  }
  EXPECT_THAT(requested, Contains(JobKind::place_search));
  EXPECT_THAT(requested, Not(Contains(JobKind::whole_map)));
}

std::vector<std::byte> bytes_of(const RobotState& state) {
  StoredMap stored;
  stored.map = offline_copy(state.mapper.online());
  return write_map(stored);
}

TEST(Step, OfACopyLeavesTheOriginal) {
  RobotState state = after(8);
  const auto before = bytes_of(state);
  RobotState copy = state;
  for (std::size_t i = 8; i < 20; ++i) process(copy, {whole(i)});
  EXPECT_EQ(bytes_of(state), before);
  EXPECT_NE(bytes_of(copy), before) << "the copy went on mapping";
  for (std::size_t i = 8; i < 20; ++i) process(state, {whole(i)});
  EXPECT_EQ(bytes_of(state), bytes_of(copy)) << "equal measurements lead to equal states";
}

}  // namespace
}  // namespace byre
