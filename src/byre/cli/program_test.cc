// Runs the program: exit codes, stdout and stderr.

#include "byre/cli/shared/program_fixture.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class Program : public ProgramTest {
 protected:
  Program() {
    std::string tum = "# time\n";
    std::string kitti;
    std::string times;
    for (int i = 0; i < 20; ++i) {
      const std::string x = std::to_string(i), y = std::to_string(i * i);
      tum += x + " " + x + " " + y + " 0 0 0 0 1\n";
      kitti += "1 0 0 " + x + " 0 1 0 " + y + " 0 0 1 0\n";
      times += x + "\n";
    }
    write("estimate.txt", tum);
    write("poses.txt", kitti);
    write("times.txt", times);
  }
};

TEST_F(Program, PrintsHelp) {
  const Outcome help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, HasSubstr("evaluate"));
  EXPECT_THAT(help.output, HasSubstr("Exit codes: 0 done, 1 failed at work, 2 wrong usage, 3 bad input"));
  const Outcome evaluate_help = run("evaluate --help");
  EXPECT_EQ(evaluate_help.exit_code, 0);
  EXPECT_THAT(evaluate_help.output, HasSubstr("--time-offset"));
  EXPECT_THAT(evaluate_help.output, HasSubstr("Examples:\n  byre evaluate --estimate"));
}

TEST_F(Program, PrintsItsVersion) {
  const Outcome outcome = run("--version");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, testing::MatchesRegex("byre [0-9]+\\.[0-9]+\\.[0-9]+\n"));
}

TEST_F(Program, RejectsWrongUsage) {
  for (const char* const arguments : {"", "evaluat", "--loud", "evaluate", "evaluate --estimate estimate.txt",
                                      "evaluate --estimate estimate.txt --truth estimate.txt --alignment rigid",
                                      "evaluate --estimate estimate.txt --truth estimate.txt --label best",
                                      "evaluate --estimate estimate.txt --truth estimate.txt --time-offset soon"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: ")) << arguments;
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
}

TEST_F(Program, SuggestsTheNearestCommandAndOption) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"mpa . -o x.byre", "unknown command 'mpa' (did you mean 'map'?)\n"},
      {"evalute --estimate estimate.txt", "unknown command 'evalute' (did you mean 'evaluate'?)\n"},
      {"colmap", "unknown command 'colmap' (did you mean 'import-colmap'?)\n"},
      {"frobnicate", "unknown command 'frobnicate'\n"},
      {"--verion", "unknown option '--verion' (did you mean '--version'?)\n"},
      {"map . --tracjetory x.txt", "unknown option '--tracjetory' (did you mean '--trajectory'?)\n"},
      {"map . -o x.byre --traj=x.txt", "unknown option '--traj' (did you mean '--trajectory'?)\n"},
      {"map . -o x.byre --frobnicate", "unknown option '--frobnicate'\n"},
      {"bag inof .", "unknown command 'inof' (did you mean 'info'?)\n"},
      {"simulate cowshed --durtion 2", "unknown option '--durtion' (did you mean '--duration'?)\n"},
      {"inspect one.byre two.byre", "The following argument was not expected: two.byre\n"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: " + message));
  }
}

TEST_F(Program, NamesBadInput) {
  write("broken.txt", "1 0 0 0 0 0 0 1\n2 0 0\n");
  write("later.txt", "101 0 0 0 0 0 0 1\n102 0 0 0 0 0 0 1\n");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--truth absent.txt", "byre: error: absent.txt: cannot be opened (check that it exists and is readable)\n"},
      {"--truth broken.txt", "byre: error: broken.txt:2: has 3 columns instead of 8"},
      {"--truth poses.txt", "byre: error: poses.txt: is in KITTI format, which has no time stamps"},
      {"--truth later.txt", "byre: error: estimate.txt: no pose of the estimate has truth at its time"},
      {"--truth .", "byre: error: .: contains no recording in a supported format"},
      {"--truth estimate.txt --frames-of absent", "byre: error: absent: is not a folder"},
      {"--truth estimate.txt --aligned absent/out.txt", "byre: error: absent/out.txt: cannot be written"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("evaluate --estimate estimate.txt " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
}

TEST_F(Program, FailsIfItsResultCannotBeWritten) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const std::string command = std::string("'") + BYRE_PROGRAM + "' evaluate --estimate '" +
                              (folder_ / "estimate.txt").string() + "' --truth '" +
                              (folder_ / "estimate.txt").string() + "' >/dev/full 2>/dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
}

TEST_F(Program, FailsIfItsHelpCannotBeWritten) {
  if (!std::filesystem::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  for (const char* const arguments : {"--help", "--version", "map --help"}) {
    const std::string command = std::string("'") + BYRE_PROGRAM + "' " + arguments + " >/dev/full 2>'" +
                                (folder_ / "errors.txt").string() + "'";
    EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1) << arguments;
    EXPECT_THAT(read("errors.txt"), StartsWith("byre: error: standard output: cannot be written (")) << arguments;
  }
}

TEST_F(Program, PrintsNoErrorIfTheReaderOfItsHelpHasEnded) {
  const std::string command = std::string("mkfifo '") + (folder_ / "pipe").string() + "'; { exec 3<>'" +
                              (folder_ / "pipe").string() + "' 4>'" + (folder_ / "pipe").string() + "' 3<&-; '" +
                              BYRE_PROGRAM + "' map --help >&4 2>'" + (folder_ / "errors.txt").string() + "'; }";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 1);
  EXPECT_THAT(read("errors.txt"), IsEmpty());
}

TEST_F(Program, ListsTheChoicesOfAnOption) {
  const std::string evaluate = "evaluate --estimate estimate.txt --truth estimate.txt ";
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"map . --pace fast", "--pace: 'fast' is not a value of pace; give inline|paced|live"},
      {"map . --format csv", "--format: 'csv' is not one of: euroc, kitti, tum"},
      {"run . --map m --frame world", "--frame: 'world' is not one of: map, plan"},
      {evaluate + "--alignment rigid", "--alignment: 'rigid' is not one of: none, origin, se3, sim3"},
      {evaluate + "--label best", "--label: 'best' is not one of: causal, final"},
      {evaluate + "--frames-of . --estimate-of x", "--estimate-of: 'x' is not one of: body, camera"},
      {"completion fish", "SHELL: 'fish' is not one of: bash, zsh"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr(message)) << arguments;
  }
}

TEST_F(Program, PrintsArgumentsWithoutControlCharacters) {
  const std::string hostile = "\"$(printf 'a\\033[2J\\nb\\377')\"";
  for (const std::string& arguments :
       {"evaluate --estimate estimate.txt --truth " + hostile, "bag info " + hostile, "map . --pace " + hostile,
        "validate " + hostile, hostile, "map . --fps " + hostile}) {
    const Outcome outcome = run(arguments);
    EXPECT_NE(outcome.exit_code, 0) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr("a\\x1b[2J\\nb\\xff")) << arguments;
    for (const char* const raw : {"\033", "\377"}) EXPECT_THAT(outcome.errors, Not(HasSubstr(raw))) << arguments;
  }
}

// Libraries for image and video formats would take most of the program's memory if linked.
TEST_F(Program, LoadsRarelyUsedLibrariesLazily) {
  const std::string list = (folder_ / "libraries.txt").string();
  const std::string command = std::string("LD_TRACE_LOADED_OBJECTS=1 '") + BYRE_PROGRAM + "' > '" + list + "'";
  ASSERT_EQ(WEXITSTATUS(std::system(command.c_str())), 0);
  const std::string libraries = read("libraries.txt");
  EXPECT_THAT(libraries, HasSubstr("libopencv_core"));
  EXPECT_THAT(libraries, Not(HasSubstr("libopencv_imgcodecs")));
  EXPECT_THAT(libraries, Not(HasSubstr("libopencv_videoio")));
}

TEST_F(Program, EvaluatesAgainstTheTruthOfKitti) {
  const Outcome outcome = run("evaluate --estimate estimate.txt --truth poses.txt --times times.txt --label final");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("poses        final\n"));
  EXPECT_THAT(outcome.output, HasSubstr("coverage     100.0 % (20 of 20 times in times.txt)\n"));
  EXPECT_THAT(outcome.output, HasSubstr("ATE            m         0.00000"));
  EXPECT_THAT(outcome.errors, IsEmpty());
}

TEST_F(Program, PrintsJsonAndWritesTheAlignedEstimate) {
  const Outcome outcome = run("evaluate --estimate estimate.txt --truth estimate.txt --json --aligned aligned.txt");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("{\n  \"protocol\": {"));
  EXPECT_THAT(read("aligned.txt"), HasSubstr("\n3.000000000 3.000000000 9.000000000 "));
}

TEST_F(Program, WritesTheAlignedEstimateInTheRequestedFormat) {
  const std::string command = "evaluate --estimate estimate.txt --truth poses.txt --times times.txt --align origin ";
  const Outcome outcome = run(command + "--aligned aligned.csv --format euroc");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("estimate     estimate.txt, 20 poses\n"));
  const std::string euroc = read("aligned.csv");
  EXPECT_EQ(std::ranges::count(euroc, '\n'), 21) << "a head, and all the poses that the report counts";
  EXPECT_THAT(euroc, HasSubstr("\n3000000000,3.000000000,9.000000000,"));
  EXPECT_EQ(run(command + "--aligned aligned.txt --format kitti").exit_code, 0);
  EXPECT_EQ(std::ranges::count(read("aligned.txt"), '\n'), 20);
  EXPECT_EQ(run(command + "--format ros").exit_code, 2);
}

TEST_F(Program, DrawsPathsAndErrors) {
  const Outcome outcome = run("evaluate --estimate estimate.txt --truth estimate.txt --plot errors.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const std::string svg = read("errors.svg");
  EXPECT_THAT(svg, StartsWith("<svg "));
  for (const char* const text : {">Path from above<", ">x [m]<", ">y [m]<", ">truth<", ">error [m]<"}) {
    EXPECT_THAT(svg, HasSubstr(text));
  }
  ASSERT_EQ(run("evaluate --estimate estimate.txt --truth poses.txt --times times.txt --plot kitti.svg").exit_code, 0);
  EXPECT_THAT(read("kitti.svg"), HasSubstr(">z [m]<")) << "KITTI's y points down";
  EXPECT_EQ(run("evaluate --estimate estimate.txt --truth estimate.txt --plot absent/errors.svg").exit_code, 3);
}

}  // namespace
}  // namespace byre::cli
