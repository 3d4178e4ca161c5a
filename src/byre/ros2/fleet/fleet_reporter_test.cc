#include "byre/ros2/fleet/fleet_link.h"

#include <chrono>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class FleetReporterTest : public testing::Test {
 protected:
  // Messages sent at a time: last part of the topic, and id.
  std::vector<std::string> publish(Timestamp now, int connections = 1) {
    sent_.clear();
    reporter_.publish(position_, {"barn", ""}, now, {}, connections);
    std::vector<std::string> summaries;
    for (const MqttMessage& message : sent_) {
      const std::string topic = message.topic.substr(message.topic.rfind('/') + 1);
      summaries.push_back(topic + " " + nlohmann::json::parse(message.text).at("headerId").dump());
      EXPECT_FALSE(message.is_retained);
      EXPECT_FALSE(message.is_acknowledged);
    }
    return summaries;
  }

  std::vector<MqttMessage> sent_;
  FleetPosition position_;
  FleetReporter reporter_{{}, 2.0, [this](const MqttMessage& message) { sent_.push_back(message); }};
};

TEST_F(FleetReporterTest, PublishesNothingBeforeConnecting) {
  EXPECT_THAT(publish(1s, 0), IsEmpty());
}

TEST_F(FleetReporterTest, PublishesPositionsAtItsRate) {
  EXPECT_THAT(publish(1s), ElementsAre("state 0", "visualization 0"));
  EXPECT_THAT(publish(1s + 499ms), IsEmpty());
  EXPECT_THAT(publish(1s + 500ms), ElementsAre("visualization 1"));
}

TEST_F(FleetReporterTest, PublishesStateChangesAtALimitedRate) {
  publish(1s);
  position_.is_initialised = true;
  EXPECT_THAT(publish(1s + 100ms), IsEmpty());
  EXPECT_THAT(publish(1s + 500ms), ElementsAre("state 1", "visualization 1"));
  position_.problem = "degraded: few points";
  EXPECT_THAT(publish(2s), ElementsAre("state 2", "visualization 2"));
}

TEST_F(FleetReporterTest, PublishesStateEveryThirtySeconds) {
  publish(1s);
  EXPECT_THAT(publish(31s - 1ms), ElementsAre("visualization 1"));
  EXPECT_THAT(publish(31s), ElementsAre("state 1"));
}

TEST_F(FleetReporterTest, PublishesStateAfterEachConnection) {
  publish(1s);
  EXPECT_THAT(publish(1s + 10ms, 2), ElementsAre("state 1"));
  EXPECT_THAT(publish(1s + 20ms, 2), IsEmpty());
}

}  // namespace
}  // namespace byre
