#include "byre/ros2/fleet/fleet_link.h"

#include <limits>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using Json = nlohmann::json;

// Required fields of the standard's schemas, json_schemas/ of version 2.1.
const std::vector<const char*> kHeaderFields = {"headerId", "timestamp", "version", "manufacturer", "serialNumber"};
const std::vector<const char*> kStateFields = {"orderId",      "orderUpdateId", "lastNodeId", "lastNodeSequenceId",
                                               "nodeStates",   "edgeStates",    "driving",    "actionStates",
                                               "batteryState", "operatingMode", "errors",     "safetyState"};
const std::vector<const char*> kPositionFields = {"x", "y", "theta", "mapId", "positionInitialized"};

void expect_fields(const Json& object, const std::vector<const char*>& fields) {
  for (const char* field : fields) EXPECT_TRUE(object.contains(field)) << field;
}

class Vda5050Messages : public testing::Test {
 protected:
  Vda5050Messages() {
    position_.x = 1.5;
    position_.y = -2.5;
    position_.theta = 0.75;
    position_.is_initialised = true;
    position_.score = 0.9;
    position_.deviation = 0.04;
    position_.velocity = FleetVelocity{0.5, 0.0, -0.1};
  }

  Json state() const { return Json::parse(state_text(identity_, header_, position_, map_)); }

  FleetIdentity identity_{"uagv", "barnworks", "robot7"};
  FleetHeader header_{3, std::chrono::system_clock::time_point(std::chrono::milliseconds(1700000000042))};
  FleetPosition position_;
  FleetMap map_{"barn", "ground floor"};
};

TEST_F(Vda5050Messages, HaveTheTopicsOfTheStandard) {
  EXPECT_EQ(fleet_topic(identity_, "state"), "uagv/v2/barnworks/robot7/state");
}

TEST_F(Vda5050Messages, OfStateContainAllRequiredFields) {
  const Json message = state();
  expect_fields(message, kHeaderFields);
  expect_fields(message, kStateFields);
  expect_fields(message.at("agvPosition"), kPositionFields);
  expect_fields(message.at("batteryState"), {"batteryCharge", "charging"});
  expect_fields(message.at("safetyState"), {"eStop", "fieldViolation"});
  EXPECT_EQ(message.at("headerId"), 3);
  EXPECT_EQ(message.at("timestamp"), "2023-11-14T22:13:20.042Z");
  EXPECT_EQ(message.at("version"), "2.1.0");
  EXPECT_EQ(message.at("serialNumber"), "robot7");
  EXPECT_EQ(message.at("operatingMode"), "MANUAL");
}

TEST_F(Vda5050Messages, ContainPositionAndVelocity) {
  for (const Json& message : {state(), Json::parse(visualization_text(identity_, header_, position_, map_))}) {
    expect_fields(message, kHeaderFields);
    EXPECT_EQ(message.at("agvPosition"), Json({{"x", 1.5},
                                               {"y", -2.5},
                                               {"theta", 0.75},
                                               {"mapId", "barn"},
                                               {"mapDescription", "ground floor"},
                                               {"positionInitialized", true},
                                               {"localizationScore", 0.9},
                                               {"deviationRange", 0.04}}));
    EXPECT_EQ(message.at("velocity"), Json({{"vx", 0.5}, {"vy", 0.0}, {"omega", -0.1}}));
  }
}

TEST_F(Vda5050Messages, OmitUnknownFields) {
  position_.deviation = std::numeric_limits<double>::infinity();
  position_.velocity.reset();
  map_.description.clear();
  const Json message = state();
  EXPECT_FALSE(message.contains("velocity"));
  EXPECT_FALSE(message.at("agvPosition").contains("deviationRange"));
  EXPECT_FALSE(message.at("agvPosition").contains("mapDescription"));
}

TEST_F(Vda5050Messages, ReportDriving) {
  EXPECT_EQ(state().at("driving"), true);
  position_.velocity = FleetVelocity{0.0, 0.001, 0.001};
  EXPECT_EQ(state().at("driving"), false);
  position_.velocity = FleetVelocity{0.0, 0.0, 0.3};
  EXPECT_EQ(state().at("driving"), true);
}

TEST_F(Vda5050Messages, ReportAnUntrustedPositionAsAnError) {
  EXPECT_THAT(state().at("errors"), IsEmpty());
  position_.problem = "degraded: few points";
  position_.advice = "clean the lens";
  Json errors = state().at("errors");
  ASSERT_THAT(errors, SizeIs(1));
  EXPECT_EQ(errors[0], Json({{"errorType", "LOCALIZATION_ERROR"},
                             {"errorLevel", "WARNING"},
                             {"errorDescription", "degraded: few points"},
                             {"errorHint", "clean the lens"}}));
  position_.is_initialised = false;
  EXPECT_EQ(state().at("errors")[0].at("errorLevel"), "FATAL");
}

TEST_F(Vda5050Messages, ReportTheConnection) {
  const std::pair<FleetConnection, const char*> states[] = {{FleetConnection::online, "ONLINE"},
                                                            {FleetConnection::offline, "OFFLINE"},
                                                            {FleetConnection::broken, "CONNECTIONBROKEN"}};
  for (const auto& [state, name] : states) {
    const Json message = Json::parse(connection_text(identity_, header_, state));
    expect_fields(message, kHeaderFields);
    EXPECT_EQ(message.at("connectionState"), name);
  }
}

TEST_F(Vda5050Messages, AreValidUtf8ForAnyMapName) {
  map_.id = "barn \xff\"";
  EXPECT_NO_THROW(state());
}

TEST_F(Vda5050Messages, EscapeControlCharacters) {
  map_.description =
      "a\xc2\x9b"
      "2J";
  EXPECT_THAT(state_text(identity_, header_, position_, map_), HasSubstr(R"("a\u009b2J")"));
}

TEST(FleetIdentityText, AcceptsCharactersOfTheStandard) {
  for (const char* sound : {"robot7", "A-1_b.c:d"}) EXPECT_THAT(fault_in_identity(sound), IsEmpty()) << sound;
  for (const char* wrong : {"", "robot 7", "a/b", "#", "+", "r\xc3\xb6"}) {
    EXPECT_THAT(fault_in_identity(wrong), Not(IsEmpty())) << wrong;
  }
}

}  // namespace
}  // namespace byre
