
#include "byre/cli/shared/program_fixture.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;

class CheckProgram : public ProgramTest {};

TEST_F(CheckProgram, FindsNoProblemInASoundRecording) {
  const Outcome outcome = run("check " + rendered_room() + " --samples 3");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << outcome.errors;
  for (const char* const row : {"frames ", "left ", "right ", "pair ", "calibration ", "baseline "}) {
    EXPECT_THAT(outcome.output, HasSubstr(row));
  }
}

TEST_F(CheckProgram, PrintsTheReportAsJson) {
  const Outcome outcome = run("check " + rendered_room() + " --samples 3 --json");
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("program"), "byre check");
  EXPECT_EQ(report.at("looked_at"), 6);
  EXPECT_GT(report.at("pair").at("matched_percent"), 40.0);
  EXPECT_LT(report.at("pair").at("calibration_error_px"), 0.2);
}

TEST_F(CheckProgram, OmitsThePairForOneCamera) {
  const json report = json::parse(run("check " + rendered_room() + " --camera left --samples 3 --json").output);
  EXPECT_TRUE(report.at("pair").is_null());
  EXPECT_EQ(report.at("without_right"), 0);
}

TEST_F(CheckProgram, ReplacesTheBaselineOfTheCalibration) {
  const Outcome sound = run("check " + rendered_room() + " --samples 3 --baseline 0.5");
  EXPECT_EQ(sound.exit_code, 0) << sound.errors;
  EXPECT_THAT(sound.output, HasSubstr("baseline     0.5000 m"));
  const Outcome confirmed = run("check " + rendered_room() + " --samples 3 --baseline 7.5");
  EXPECT_THAT(confirmed.output, HasSubstr("baseline     7.5000 m"));
  EXPECT_NE(run("check " + rendered_room() + " --samples 3 --baseline 0").exit_code, 0);
}

TEST_F(CheckProgram, PrintsASummaryBeforeMapping) {
  const Outcome outcome = run("map " + rendered_room() + " --frames :4 --no-loops -o room.byre");
  EXPECT_THAT(outcome.errors, HasSubstr("checked "));
}

}  // namespace
}  // namespace byre::cli
