#include "byre/ros2/node/input_monitor.h"

#include <map>

#include <gmock/gmock.h>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;

constexpr const char* kImage = "sensor_msgs/msg/Image";
const DiscoveredPublisher kSuitable{kImage, true, false};
const DiscoveredPublisher kBestEffort{kImage, false, false};

class Inputs : public testing::Test {
 protected:
  InputMonitor::Id add(bool is_once = false) {
    WatchedInput input{"left images", "/left", {kImage}, {.is_reliable = true}};
    input.is_once = is_once;
    input.remedy_for_type = "set images.compressed: true";
    input.remedy_for_reliability = "set images.reliable: false";
    input.matched = [this] { return matched_; };
    return monitor_.add(std::move(input));
  }
  // Lines of checks at 5 Hz for a time; arriving: input with a message before each check.
  std::vector<LogLine> run(Timestamp duration, std::optional<InputMonitor::Id> arriving = {}) {
    std::vector<LogLine> lines;
    for (const Timestamp end = now_ + duration; now_ < end;) {
      now_ += 200ms;
      if (arriving) monitor_.note_arrival(*arriving);
      for (LogLine& line : monitor_.check(now_)) lines.push_back(std::move(line));
    }
    return lines;
  }

  Timestamp now_ = 100s;
  int matched_ = 0;
  std::map<std::string, std::vector<DiscoveredPublisher>> published_;
  InputMonitor monitor_{[this](const std::string& topic) { return published_[topic]; }, now_};
};

TEST_F(Inputs, WarnOnceAfterFiveSeconds) {
  add();
  EXPECT_THAT(run(4800ms), IsEmpty());
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kOk);
  const std::string text =
      "no left images on /left for 5 s: no publisher; check its program, the topic and ROS_DOMAIN_ID";
  EXPECT_THAT(run(200ms), ElementsAre(LogLine{LogLevel::warning, text}));
  EXPECT_THAT(run(60s), IsEmpty());
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kWarn);
  EXPECT_EQ(monitor_.status().message, text);
  ASSERT_THAT(monitor_.status().values, SizeIs(1));
  EXPECT_EQ(monitor_.status().values[0].value, "silent");
}

TEST_F(Inputs, ReportArrivalAndTheNextSilence) {
  const InputMonitor::Id images = add();
  EXPECT_THAT(run(10s), SizeIs(1));
  EXPECT_THAT(run(20s, images), ElementsAre(LogLine{LogLevel::info, "left images received on /left"}));
  EXPECT_EQ(monitor_.status().message, "no input is missing");
  matched_ = 2;
  EXPECT_THAT(run(4800ms), IsEmpty());
  EXPECT_THAT(run(10s), ElementsAre(LogLine{LogLevel::warning,
                                            "no left images on /left for 5 s: 2 publishers connected, without a "
                                            "message; check that it runs"}));
}

TEST_F(Inputs, AreSilentInTheLogWhileMessagesArrive) {
  EXPECT_THAT(run(60s, add()), IsEmpty());
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kOk);
}

TEST_F(Inputs, NameThePublishersThatDoNotSuit) {
  add();
  published_["/left"] = {kBestEffort, {"sensor_msgs/msg/CompressedImage", true, true}, kBestEffort};
  const auto lines = run(10s);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0].text,
              AllOf(HasSubstr("2 publishers not connected: QoS best effort, volatile, required reliable, volatile; set "
                              "images.reliable: false"),
                    HasSubstr("1 publisher not connected: type sensor_msgs/msg/CompressedImage, required "
                              "sensor_msgs/msg/Image; set images.compressed: true"),
                    Not(HasSubstr("no publisher"))));
}

TEST_F(Inputs, RequireLatchedPublishersOfLatchedTopics) {
  monitor_.add({"transform", "/tf_static", {"tf2_msgs/msg/TFMessage"}, {.is_latched = true}});
  published_["/tf_static"] = {{"tf2_msgs/msg/TFMessage", true, false}};
  const auto lines = run(10s);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0].text, HasSubstr("QoS reliable, volatile, required reliable, transient local"));
}

TEST_F(Inputs, ReportALaterPublisherThatDoesNotSuitOnce) {
  add();
  EXPECT_THAT(run(10s), SizeIs(1));
  published_["/left"] = {kSuitable};
  EXPECT_THAT(run(10s), IsEmpty()) << "its messages will arrive, or the first line holds";
  published_["/left"] = {kBestEffort};
  const auto lines = run(10s);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0].text, HasSubstr("QoS best effort"));
  published_["/left"].clear();
  EXPECT_THAT(run(10s), IsEmpty());
  EXPECT_THAT(monitor_.status().message, HasSubstr("no publisher")) << "diagnostics show the present facts";
  published_["/left"] = {kBestEffort};
  EXPECT_THAT(run(10s), IsEmpty()) << "the same reason";
}

TEST_F(Inputs, NeedSomeMessagesOnlyOnce) {
  const InputMonitor::Id info = add(true);
  EXPECT_THAT(run(200ms, info), IsEmpty());
  EXPECT_THAT(run(60s), IsEmpty());
  EXPECT_EQ(monitor_.status().values[0].value, "arrived");
}

TEST_F(Inputs, AreNotMissedWhileTheyAreNotNeeded) {
  const InputMonitor::Id images = add();
  monitor_.set_needed(images, false);
  EXPECT_THAT(run(60s), IsEmpty());
  EXPECT_EQ(monitor_.status().values[0].value, "not needed");
  monitor_.set_needed(images, true);
  EXPECT_THAT(run(4800ms), IsEmpty()) << "silence counts from now";
  EXPECT_THAT(run(400ms), SizeIs(1));
  monitor_.set_needed(images, false);
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kOk);
}

TEST_F(Inputs, AreNotMissedWhileTheNodeIsBusy) {
  const InputMonitor::Id images = add();
  run(1s, images);
  now_ += 300s;  // loads a map
  EXPECT_THAT(run(3800ms), IsEmpty());
  EXPECT_THAT(run(1s), SizeIs(1));
}

TEST_F(Inputs, OfOtherNodesOnAnOwnTopicAreReportedOnce) {
  monitor_.add(WatchedOutput{"/map", "stop it"});
  EXPECT_THAT(run(60s), IsEmpty());
  published_["/map"] = {kSuitable};
  EXPECT_THAT(run(10s), IsEmpty()) << "it may be one of a process that has crashed";
  const std::string text = "/map has a second publisher, of another node: stop it";
  EXPECT_THAT(run(10s), ElementsAre(LogLine{LogLevel::warning, text}));
  EXPECT_THAT(run(60s), IsEmpty());
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kWarn);
  EXPECT_EQ(monitor_.status().message, text);
  published_["/map"].clear();
  EXPECT_THAT(run(1s), ElementsAre(LogLine{LogLevel::info, "no other node publishes /map any more"}));
  EXPECT_EQ(monitor_.status().level, ros::DiagnosticStatus::kOk);
  published_["/map"] = {kSuitable};
  EXPECT_THAT(run(20s), SizeIs(1));
}

TEST_F(Inputs, OfACrashedProcessOnAnOwnTopicAreNotReported) {
  monitor_.add(WatchedOutput{"/map", "stop it"});
  for (int i = 0; i < 3; ++i) {
    published_["/map"] = {kSuitable};
    EXPECT_THAT(run(11s), IsEmpty());
    published_["/map"].clear();
    EXPECT_THAT(run(1s), IsEmpty());
  }
}

TEST_F(Inputs, EscapeTypesOfOtherPrograms) {
  add();
  published_["/left"] = {{"a\x1b[2Jb", true, false}, {"", true, false}};
  const auto lines = run(10s);
  ASSERT_THAT(lines, SizeIs(1));
  EXPECT_THAT(lines[0].text, AllOf(HasSubstr("type a\\x1b[2Jb,"), HasSubstr("type not of ROS,")));
}

}  // namespace
}  // namespace byre
