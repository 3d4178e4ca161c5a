#include "byre/playback/report/event_log.h"

#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using nlohmann::json;
using testing::ElementsAre;

PlayedFrame frame_at(double seconds, State state, Verdict verdict, std::vector<SessionEvent> events = {}) {
  FrameReport report;
  report.time = from_seconds(seconds);
  report.state = state;
  report.health.verdict = verdict;
  report.events = std::move(events);
  PlayedFrame frame;
  frame.time = report.time;
  frame.report = report;
  return frame;
}

std::vector<json> lines_of(const std::vector<PlayedFrame>& frames) {
  std::stringstream stream;
  EventLog log(stream);
  for (std::size_t i = 0; i < frames.size(); ++i) log.note(static_cast<int>(i), frames[i]);
  std::vector<json> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(json::parse(line));
  return lines;
}

std::vector<std::string> events_of(const std::vector<json>& lines) {
  std::vector<std::string> events;
  for (const json& line : lines) events.push_back(line.at("event"));
  return events;
}

TEST(EventLog, BeginsWithTheFirstStateAndVerdict) {
  const std::vector<json> lines = lines_of({frame_at(0.5, State::initialising, Verdict::untrusted)});
  EXPECT_THAT(events_of(lines), ElementsAre("state changed", "verdict changed"));
  EXPECT_EQ(lines[0].at("state"), "initialising");
  EXPECT_TRUE(lines[0].at("before").is_null());
  EXPECT_EQ(lines[1].at("verdict"), "untrusted");
  EXPECT_EQ(lines[1].at("doubt"), "no pose");
  EXPECT_EQ(lines[1].at("health").at("offline_inliers"), 0);
}

TEST(EventLog, ContainsOnlyChanges) {
  const PlayedFrame steady = frame_at(0.1, State::tracking, Verdict::trusted);
  const std::vector<json> lines = lines_of({steady, steady, frame_at(0.3, State::tracking, Verdict::degraded)});
  EXPECT_THAT(events_of(lines), ElementsAre("state changed", "verdict changed", "verdict changed"));
  EXPECT_EQ(lines[2].at("before"), "trusted");
  EXPECT_EQ(lines[2].at("verdict"), "degraded");
  EXPECT_EQ(lines[2].at("frame"), 2);
  EXPECT_DOUBLE_EQ(lines[2].at("time_s"), 0.3);
}

TEST(EventLog, ContainsEventsOfAFrameInOrderWithPoseAndDistance) {
  PlayedFrame lost = frame_at(7.0, State::lost, Verdict::untrusted, {SessionEvent::pose_lost, SessionEvent::blinded});
  lost.report->health.distance_since_offline = 1.5;
  lost.report->health.seconds_since_offline = 3.0;
  lost.report->health.doubt = DistrustReason::blinded;
  lost.report->health.image = ImageCondition{2.0f, 1.0f, 0.5f, 0.25f};
  const std::vector<json> lines = lines_of({lost});
  EXPECT_THAT(events_of(lines), ElementsAre("pose lost", "blinded", "state changed", "verdict changed"));
  EXPECT_TRUE(lines[0].at("position_m").is_null());
  EXPECT_EQ(lines[0].at("doubt"), "blinded");
  EXPECT_EQ(lines[0].at("distance_since_offline_m"), 1.5);
  EXPECT_EQ(lines[0].at("seconds_since_offline"), 3.0);
  EXPECT_FALSE(lines[0].contains("image"));
  EXPECT_EQ(lines[1].at("image").at("sharpness"), 0.25);
}

TEST(EventLog, ContainsTheJumpOfAMapCorrection) {
  const auto with_poses = [](PlayedFrame frame, double map_x, double odometry_x) {
    frame.report->map_from_body = Pose{Eigen::Quaterniond::Identity(), {map_x, 0.0, 0.0}};
    frame.report->odometry_from_body = Pose{Eigen::Quaterniond::Identity(), {odometry_x, 0.0, 0.0}};
    return frame;
  };
  const PlayedFrame before = with_poses(frame_at(0.0, State::tracking, Verdict::trusted), 10.0, 0.0);
  const PlayedFrame after =
      with_poses(frame_at(0.1, State::tracking, Verdict::trusted, {SessionEvent::online_corrected}), 10.5, 0.25);
  const std::vector<json> lines = lines_of({before, after});
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[2].at("event"), "online map corrected");
  EXPECT_DOUBLE_EQ(lines[2].at("jump_m"), 0.25);
  EXPECT_EQ(lines[2].at("position_m"), (json{10.5, 0.0, 0.0}));
  const std::vector<json> first = lines_of({after});
  EXPECT_TRUE(first[0].at("jump_m").is_null()) << "no previous frame";
}

TEST(EventLog, SkipsUnreadableFrames) {
  const PlayedFrame steady = frame_at(0.1, State::tracking, Verdict::trusted);
  EXPECT_THAT(lines_of({steady, PlayedFrame{}, steady}), testing::SizeIs(2));
}

}  // namespace
}  // namespace byre
