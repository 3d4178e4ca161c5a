
#include "byre/cli/shared/program_fixture.h"
#include "byre/recording.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class SimulateProgram : public ProgramTest {};

const std::string kSmall = "simulate cowshed --duration 0.2 --rate 10 --divide 8 ";
const std::string kByTwoThreads = kSmall + "--threads 2 -o barn";  // for run_once

TEST_F(SimulateProgram, RendersAReadableRecording) {
  const Outcome outcome = run_once(kByTwoThreads);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("rendered     2 stereo pairs in "));
  EXPECT_THAT(outcome.output, HasSubstr("recording    barn\n"));
  const auto recording = open_recording(folder_ / "barn", {});
  EXPECT_EQ(recording->size(), 2);
  EXPECT_EQ(recording->calibration().left.width, 94);
  EXPECT_TRUE(fs::exists(folder_ / "barn" / "plan" / "picks.csv"));
}

TEST_F(SimulateProgram, RendersImagesOfTheRequestedSize) {
  const std::string quick = "simulate cowshed --duration 0.2 --rate 10 ";
  EXPECT_EQ(run(quick + "--size 96x80 -o barn --quiet").exit_code, 0);
  const auto recording = open_recording(folder_ / "barn", {});
  EXPECT_EQ(recording->calibration().left.width, 96);
  EXPECT_EQ(recording->calibration().left.height, 80);
  const Outcome refused = run(quick + "--size 96:80 -o barn2");
  EXPECT_NE(refused.exit_code, 0);
  EXPECT_THAT(refused.errors, HasSubstr("--size: must be WIDTHxHEIGHT in pixels, such as 640x480, not \"96:80\""));
}

TEST_F(SimulateProgram, WritesTheSameBytesForTheSameOptions) {
  EXPECT_EQ(run(kSmall + "--threads 1 -o one --quiet").exit_code, 0);
  EXPECT_EQ(run_once(kByTwoThreads).exit_code, 0);
  for (const char* file : {"mav0/cam0/data/100000000000000.png", "mav0/cam1/data/100000100000000.png",
                           "mav0/state_groundtruth_estimate0/data.csv", "plan/plan.png", "plan/picks.csv"}) {
    EXPECT_FALSE(read(std::string("one/") + file).empty()) << file;
    EXPECT_EQ(read(std::string("one/") + file), read(std::string("barn/") + file)) << file;
  }
}

TEST_F(SimulateProgram, RendersTheDaysOfALife) {
  const std::string life = "simulate life --duration 0.2 --rate 10 --divide 8 -o life ";
  const Outcome first = run(life + "--only 1 3");
  EXPECT_EQ(first.exit_code, 0) << first.errors;
  EXPECT_THAT(first.output, HasSubstr("2 visits; 0 were there already"));
  EXPECT_EQ(open_recording(folder_ / "life" / "day_03", {})->size(), 2);
  fs::create_directories(folder_ / "life" / "day_46.unfinished" / "mav0");
  const Outcome later = run(life + "--only 3 46 --quiet");
  EXPECT_THAT(later.output, HasSubstr("1 visits; 1 were there already"));
  EXPECT_TRUE(fs::exists(folder_ / "life" / "day_46" / "mav0"));
  EXPECT_FALSE(fs::exists(folder_ / "life" / "day_46.unfinished"));
}

TEST_F(SimulateProgram, WritesTheTrueCalibrationToo) {
  EXPECT_EQ(run_once(kByTwoThreads).exit_code, 0);
  EXPECT_EQ(run(kSmall + "--calibration-level 1 --calibration-seed 4 -o erring --quiet").exit_code, 0);
  EXPECT_EQ(read("barn/mav0/cam0/data/100000000000000.png"), read("erring/mav0/cam0/data/100000000000000.png"));
  EXPECT_NE(read("barn/mav0/cam0/sensor.yaml"), read("erring/mav0/cam0/sensor.yaml"));
  EXPECT_EQ(read("barn/mav0/cam0/sensor.yaml"), read("erring/mav0/cam0/true_sensor.yaml"));
  EXPECT_EQ(read("barn/mav0/cam1/sensor.yaml"), read("erring/mav0/cam1/true_sensor.yaml"));
  EXPECT_FALSE(fs::exists(folder_ / "barn/mav0/cam0/true_sensor.yaml"));
}

TEST_F(SimulateProgram, WritesTheSameBytesForTheSameImperfection) {
  const std::string all = "--imperfection worn --rolling-shutter 15 --time-offset 3 --dirt 1 --quiet ";
  EXPECT_EQ(run(kSmall + all + "--threads 1 -o one").exit_code, 0);
  EXPECT_EQ(run(kSmall + all + "--threads 2 -o two").exit_code, 0);
  for (const char* file : {"mav0/cam0/data/100000100000000.png", "mav0/cam1/data/100000100000000.png",
                           "mav0/cam0/sensor.yaml", "mav0/cam1/sensor.yaml", "plan/pick_pixels.csv"}) {
    EXPECT_FALSE(read(std::string("one/") + file).empty()) << file;
    EXPECT_EQ(read(std::string("one/") + file), read(std::string("two/") + file)) << file;
  }
}

TEST_F(SimulateProgram, LetsOptionsOverrideThePreset) {
  const Outcome outcome = run(kSmall + "--imperfection good --gain 1.5 --rolling-shutter 15 -o barn --json --quiet");
  const json imperfection = json::parse(outcome.output).at("imperfection");
  EXPECT_EQ(imperfection.at("calibration_level"), 1.0);
  EXPECT_EQ(imperfection.at("gain"), 1.5);
  EXPECT_DOUBLE_EQ(imperfection.at("rolling_shutter_s"), 0.015);
  EXPECT_EQ(run(kSmall + "--imperfection new -o barn_2").exit_code, 2);
  EXPECT_EQ(run(kSmall + "--jpeg 0 -o barn_2").exit_code, 2);
}

TEST_F(SimulateProgram, ReportsAsJson) {
  const Outcome outcome = run(kSmall + "--mission 2 --seed 7 -o barn --json --quiet");
  EXPECT_THAT(outcome.errors, IsEmpty());
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("mission"), 2);
  EXPECT_EQ(report.at("seed"), 7);
  EXPECT_EQ(report.at("frames"), 2);
}

TEST_F(SimulateProgram, DoesNotOverwriteARecording) {
  fs::create_directories(folder_ / "barn" / "mav0");
  const Outcome outcome = run(kSmall + "-o barn");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, StartsWith("byre: error: barn: already contains a recording"));
}

TEST_F(SimulateProgram, LeavesNoFilesAtCtrlC) {
  const pid_t process =
      start({"simulate", "cowshed", "--duration", "600", "--divide", "8", "-o", (folder_ / "barn").string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("rendering", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_TRUE(fs::is_empty(folder_ / "barn"));
}

TEST_F(SimulateProgram, RejectsWrongUsage) {
  EXPECT_EQ(run("simulate").exit_code, 2);
  EXPECT_EQ(run("simulate cowshed").exit_code, 2);
  EXPECT_EQ(run("simulate cowshed --mission 0 -o barn").exit_code, 2);
  EXPECT_EQ(run("simulate cowshed --change 2 -o barn").exit_code, 2);
  EXPECT_EQ(run("simulate stable -o barn").exit_code, 2);
}

TEST_F(SimulateProgram, ListsTheChoicesOfAnOption) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--time night", "--time: 'night' is not one of: day, dusk"},
      {"--gate ajar", "--gate: 'ajar' is not one of: closed, open"},
      {"--turn u", "--turn: 'u' is not one of: arc, spot"},
      {"--imperfection bad", "--imperfection: 'bad' is not one of: exact, good, worn"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("simulate cowshed " + arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr(message)) << arguments;
  }
}

}  // namespace
}  // namespace byre::cli
