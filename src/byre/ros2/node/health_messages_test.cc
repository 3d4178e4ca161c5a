#include "byre/ros2/node/health_messages.h"

#include "byre/io/ros/message_matchers.h"
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::Pair;

const std::string kDamage = "barn.byre: section 'points' is damaged (restore a copy)";

FrameReport report_with(Verdict verdict, DistrustReason doubt) {
  FrameReport report;
  report.health.verdict = verdict;
  report.health.doubt = doubt;
  return report;
}

const FrameReport kSound = report_with(Verdict::trusted, DistrustReason::none);
const FrameReport kDamaged = report_with(Verdict::untrusted, DistrustReason::map_damaged);

using LogLines = std::vector<std::pair<LogLevel, std::string>>;

LogLines lines_of(const FrameReport& report, const std::optional<FrameReport>& last,
                  const std::optional<std::string>& map_damage = {}) {
  LogLines lines;
  const auto source_of = [](MotionSensor) { return std::string("/odom"); };
  log_changes(report, last, map_damage, source_of,
              [&](LogLevel level, const std::string& line) { lines.emplace_back(level, line); });
  return lines;
}

TEST(LocalisationStatus, IsAnErrorWithARemedyIfTheMapIsDamaged) {
  const ros::DiagnosticStatus status = localisation_status(kDamaged);
  EXPECT_EQ(status.level, ros::DiagnosticStatus::kError);
  EXPECT_EQ(status.message, "untrusted: map file is damaged; replace the map file by a copy and load it again");
}

TEST(LocalisationStatus, HasTheLevelOfTheVerdict) {
  EXPECT_EQ(localisation_status(kSound).level, ros::DiagnosticStatus::kOk);
  EXPECT_EQ(localisation_status(kSound).message, "trusted");
  EXPECT_EQ(localisation_status(report_with(Verdict::degraded, DistrustReason::few_points)).level,
            ros::DiagnosticStatus::kWarn);
}

TEST(RegistryStatus, WarnsOfFaultsRefusalsAndSessionsThatAreNotStored) {
  const std::chrono::system_clock::time_point now(std::chrono::hours(500'000));
  RobotLinkState state;
  state.present = "3f2a90cc51d07be4";
  EXPECT_EQ(registry_status(state, now).message, "not contacted yet");
  state.contact = now - std::chrono::seconds(90);
  state.waiting = 3;
  state.fetched = "90b1c2ffe0217a6d";
  const ros::DiagnosticStatus sound = registry_status(state, now);
  EXPECT_EQ(sound.level, ros::DiagnosticStatus::kOk);
  EXPECT_EQ(sound.message, "version 90b1c2ffe0217a6d waits for the command update");
  std::string values;
  for (const ros::KeyValue& value : sound.values) values += value.key + "=" + value.value + "|";
  EXPECT_THAT(values,
              testing::AllOf(testing::HasSubstr("version in use=3f2a90cc51d07be4|"),
                             testing::HasSubstr("sessions waiting=3|"), testing::HasSubstr("last contact=90 s ago|")));
  state.refused = state.fetched;
  state.reason = "poses move";
  state.fault = "no network";
  state.left_out = 2;
  const ros::DiagnosticStatus status = registry_status(state, now);
  EXPECT_EQ(status.level, ros::DiagnosticStatus::kWarn);
  EXPECT_EQ(status.message,
            "no network; version 90b1c2ffe0217a6d is refused: poses move; 2 sessions were not stored, as those that "
            "wait exceed registry.max_megabytes");
}

TEST(HealthLine, ReportsDamageOfTheMap) {
  const auto health = nlohmann::json::parse(health_line(kDamaged)).at("health");
  EXPECT_EQ(health.at("verdict"), "untrusted");
  EXPECT_EQ(health.at("doubt"), "map file is damaged");
}

TEST(LogChanges, ReportsDamageOfTheMapOnceAsAnError) {
  EXPECT_THAT(lines_of(kDamaged, kSound, kDamage),
              ElementsAre(Pair(LogLevel::error, kDamage), Pair(LogLevel::warning, "untrusted: map file is damaged")));
  EXPECT_THAT(lines_of(kDamaged, kDamaged, kDamage), IsEmpty());
  EXPECT_THAT(lines_of(kDamaged, {}, kDamage), ElementsAre(Pair(LogLevel::error, kDamage), testing::_))
      << "in the first frame";
}

TEST(LogChanges, ReportsDamageThatAnUntrustedFrameFinds) {
  EXPECT_THAT(lines_of(kDamaged, report_with(Verdict::untrusted, DistrustReason::no_pose), kDamage),
              ElementsAre(Pair(LogLevel::error, kDamage)));
}

TEST(LogChanges, ReportsEventsFaultsAndVerdicts) {
  FrameReport report = kSound;
  report.events = {SessionEvent::navigation_error};
  report.warnings = {{MotionSensor::wheels, {}, "the pose jumps", "check the driver"}};
  const std::string event(to_string(SessionEvent::navigation_error));
  EXPECT_THAT(lines_of(report, kDamaged),
              ElementsAre(Pair(LogLevel::error, event),
                          Pair(LogLevel::warning, "wheels (/odom): the pose jumps; check the driver"),
                          Pair(LogLevel::notice, "trusted")));
}

}  // namespace
}  // namespace byre
