// byre node and fleet control: positions by MQTT, following VDA 5050, through a real broker.

#include "mqtt_peer.h"
#include "node_fixture.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::testing_ros2 {
namespace {

using Json = nlohmann::json;

class FleetTest : public ByreNode {
 protected:
  void SetUp() override {
    if (!MqttBroker::is_installed()) GTEST_SKIP() << "mosquitto is not installed";
  }

  std::string settings(const MqttBroker& broker) const {
    std::ofstream(folder_ / "password") << "secret\n";
    return mission("mqtt:\n  host: 127.0.0.1\n  port: " + std::to_string(broker.port()) +
                   "\n  manufacturer: barnworks\n  serial_number: robot7\n  rate: 20\n  user: byre\n  password_file: " +
                   (folder_ / "password").string() + "\n");
  }

  // Sends frames until the fleet receives a localised position.
  bool is_found(MqttListener& fleet) {
    for (const ImageFrame& frame : Room::shared().frames()) {
      answer_to(feed_, odometry_, frame);
      if (fleet.find(kState, is_known, std::chrono::milliseconds(1))) return true;
    }
    return fleet.find(kState, is_known).has_value();
  }
  static bool is_known(const Json& message) { return message.at("agvPosition").at("positionInitialized") == true; }

  static constexpr const char* kState = "uagv/v2/barnworks/robot7/state";
  static constexpr const char* kVisualization = "uagv/v2/barnworks/robot7/visualization";
  static constexpr const char* kConnection = "uagv/v2/barnworks/robot7/connection";
};

MqttListener::Condition connection_is(const std::string& state) {
  return [state](const Json& message) { return message.at("connectionState") == state; };
}

TEST_F(FleetTest, PublishesTheRobotPosition) {
  const MqttBroker broker(folder_, "byre", "secret");
  NodeProcess node(folder_, settings(broker), domain_);
  MqttListener fleet(broker, "uagv/#");
  ASSERT_TRUE(fleet.find(kVisualization, [](const Json& message) { return !is_known(message); }))
      << node.stderr_output();
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  ASSERT_TRUE(is_found(fleet)) << node.stderr_output();
  const auto shown = fleet.find(kVisualization, is_known);
  ASSERT_TRUE(shown);
  EXPECT_EQ(shown->at("agvPosition").at("mapId"), "room");
  EXPECT_GT(shown->at("agvPosition").at("localizationScore"), 0.5);
  EXPECT_EQ(node.stop(), 0);
  EXPECT_TRUE(fleet.find(kConnection, connection_is("OFFLINE"))) << "a regular stop is announced";
}

TEST_F(FleetTest, ReconnectsToTheBrokerWithoutDelayingFrames) {
  std::optional<MqttBroker> broker(std::in_place, folder_, "byre", "secret");
  const int port = broker->port();
  NodeProcess node(folder_, settings(*broker), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  {
    MqttListener fleet(*broker, "uagv/#");
    EXPECT_TRUE(fleet.find(kConnection, connection_is("ONLINE"))) << "is latched for late joiners";
  }
  broker->kill();
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_TRUE(answer_to(feed_, odometry_, Room::shared().frames()[i])) << "frame " << i << "\n"
                                                                         << node.stderr_output();
  }
  broker.emplace(folder_, "byre", "secret", port);
  MqttListener fleet(*broker, "uagv/#");
  EXPECT_TRUE(fleet.find(kConnection, connection_is("ONLINE"))) << node.stderr_output();
  EXPECT_TRUE(fleet.find(kVisualization, [](const Json&) { return true; })) << node.stderr_output();
  EXPECT_TRUE(node.is_running());
  kill(node.process(), SIGKILL);
  EXPECT_TRUE(fleet.find(kConnection, connection_is("CONNECTIONBROKEN"))) << "the broker publishes the will";
}

TEST_F(FleetTest, ReportsAnAbsentBroker) {
  std::optional<MqttBroker> broker(std::in_place, folder_, "byre", "secret");
  const std::string given = settings(*broker);
  const std::string place = "127.0.0.1:" + std::to_string(broker->port());
  broker.reset();
  NodeProcess node(folder_, given, domain_);
  EXPECT_TRUE(eventually([&] {
    return node.stderr_output().find("mqtt: " + place + " cannot be reached: Connection refused (start the broker, ") !=
           std::string::npos;
  })) << node.stderr_output();
}

TEST_F(FleetTest, ReportsARejectionByTheBroker) {
  const MqttBroker broker(folder_, "byre", "another");
  NodeProcess node(folder_, settings(broker), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  EXPECT_TRUE(eventually([&] { return node.stderr_output().find("refuses the connection") != std::string::npos; }))
      << node.stderr_output();
}

}  // namespace
}  // namespace byre::testing_ros2
