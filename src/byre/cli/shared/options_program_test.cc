// "--options" and "--print-options": output, precedence and rejection.

#include "byre/cli/shared/program_fixture.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class OptionsProgram : public ProgramTest {
 protected:
  // A command with all required options, plus these arguments.
  Outcome map(const std::string& arguments) const {
    return run("map '" + RenderedFixture::shared().folder().string() + "' --trajectory out.txt --quiet " + arguments);
  }
};

TEST_F(OptionsProgram, PrintsAllOptionsAndExits) {
  for (const char* const command : {"map", "run", "benchmark", "calibrate", "draw"}) {
    const Outcome outcome = run(std::string(command) + " --print-options");
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
    EXPECT_THAT(outcome.errors, IsEmpty());
    EXPECT_THAT(outcome.output,
                HasSubstr("\ntracking:\n  local_keyframes: 15  # keyframes of each map whose points "
                          "are searched in a frame (keyframes, from 1 to 10000)\n  search_radius_px: 12  # "))
        << command;
  }
  EXPECT_EQ(map("--print-options").exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.txt"));
}

TEST_F(OptionsProgram, ReadsItsPrintedOptions) {
  write("mine.yaml", "features:\n  max_count: 321\nhealth: {sigmas: 2.5}\n");
  const Outcome printed = run("map --options mine.yaml --print-options");
  EXPECT_THAT(printed.output, AllOf(HasSubstr("  max_count: 321  #"), HasSubstr("  sigmas: 2.5  #")));
  write("all.yaml", printed.output);
  EXPECT_EQ(run("map --options all.yaml --print-options").output, printed.output);
}

TEST_F(OptionsProgram, LetsTheCommandLineWinOverTheFile) {
  write("mine.yaml", "pace: live\ntracking: {offline_weight: 5}\n");
  EXPECT_THAT(run("map --options mine.yaml --print-options").output,
              AllOf(HasSubstr("pace: live  #"), HasSubstr("  refine: true  #")));
  EXPECT_THAT(run("map --print-options --pace inline --no-self-calibration --options mine.yaml").output,
              AllOf(HasSubstr("pace: inline  #"), HasSubstr("  refine: false  #")));
  EXPECT_THAT(run("run --options mine.yaml --offline-weight 3 --print-options").output,
              HasSubstr("  offline_weight: 3  #"));
}

TEST_F(OptionsProgram, SetsSingleOptions) {
  write("mine.yaml", "features:\n  max_count: 321\n");
  const Outcome outcome = run(
      "map --set features.max_count=300 --options mine.yaml --set loops.close=false --set pace=live --print-options");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("  max_count: 300  #"), HasSubstr("  close: false  #"), HasSubstr("pace: live  #")));
}

TEST_F(OptionsProgram, RejectsAnExtensionWithoutLoopClosing) {
  write("mine.yaml", "loops: {close: false}\n");
  for (const char* const off : {"--no-loops", "--set loops.close=false", "--options mine.yaml"}) {
    EXPECT_THAT(map(std::string("-o new.byre --extend old.byre ") + off).errors, HasSubstr("needs place recognition"))
        << off;
  }
}

TEST_F(OptionsProgram, RejectsFaultySingleOptions) {
  EXPECT_THAT(map("--set features.max_cont=300").errors, HasSubstr("did you mean 'features.max_count'?"));
  EXPECT_THAT(map("--set features.max_count=0").errors, HasSubstr("'0' is not a value of features.max_count"));
  EXPECT_THAT(map("--set features.max_count").errors, HasSubstr("give NAME=VALUE"));
  EXPECT_EQ(map("--set features.max_count=0").exit_code, 2);
  EXPECT_THAT(map("--pace fast").errors, HasSubstr("'fast' is not a value of pace; give inline|paced|live"));
}

TEST_F(OptionsProgram, UsesAndReportsChangedOptions) {
  write("mine.yaml", "pace: inline\nfeatures:\n  max_count: 300\n");
  const Outcome outcome = map("--options mine.yaml --frames :6 --stats stats.json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const json stats = json::parse(read("stats.json"));
  EXPECT_EQ(stats.at("protocol").at("options").at("changed"),
            json({{"pace", "inline"}, {"features.max_count", "300"}}));
  EXPECT_EQ(stats.at("protocol").at("pace"), "inline");
  for (const json& frame : stats.at("frames")) EXPECT_LE(frame.at("features"), 300);
}

TEST_F(OptionsProgram, RejectsAFaultyFileWithItsLine) {
  write("mine.yaml", "pace: live\ntracking:\n  serch_radius_px: 20\n");
  for (const std::string more : {"", " --print-options"}) {
    const Outcome outcome = map("--options mine.yaml" + more);
    EXPECT_EQ(outcome.exit_code, 3);
    EXPECT_THAT(
        outcome.errors,
        HasSubstr(
            "mine.yaml:3: unknown option 'tracking.serch_radius_px' (did you mean 'tracking.search_radius_px'?)"));
    EXPECT_EQ(map("--options absent.yaml" + more).exit_code, 3);
  }
}

}  // namespace
}  // namespace byre::cli
