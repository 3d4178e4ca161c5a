#include "byre/benchmark/report.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre {
namespace {

using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

const BenchmarkSetting kSetting{"barns.yaml", "/data", Pace::paced, 2};

RunMeasures measures(double map_error, double coverage) {
  RunMeasures result;
  result.final_poses.coverage = coverage;
  result.final_poses.ate = 0.004;
  result.final_poses.map_error = map_error;
  result.behaviour.losses = 1.0;
  result.cost.frame_ms_mean = 14.25;
  return result;
}

BenchmarkProtocol protocol() {
  BenchmarkProtocol result;
  result.name = "barns";
  result.title = "Barns";
  result.runs = 3;
  result.cases = {{"b*", "b", "a", {Arm::hybrid}}};
  TrajectoryMeasures figures;
  figures.map_error = 0.0119;
  result.published = {{"Others", "As printed.", {{"b*", figures}}}, {"Elsewhere", "Not shown.", {}}};
  return result;
}

BenchmarkResult result() {
  BenchmarkResult result;
  ArmResult arm;
  arm.arm = Arm::localise_only;
  arm.runs = {{0, measures(0.005, 1.0), {}}, {1, measures(0.006, 0.5), {}}, {2, measures(0.010, 0.9), {"torn image"}}};
  CaseResult one;
  one.what = protocol().cases.front();
  one.arms = {arm};
  result.cases = {one};
  result.maps = {{"a", "out/a.byre", 120, 9000, {{}, 118}, 12.5}};
  result.skipped = {{"c", "/data/c does not exist"}};
  return result;
}

TEST(BenchmarkMarkdown, DescribesTheProtocol) {
  const std::string text = to_markdown(result(), protocol(), kSetting);
  for (const char* part : {"# Barns", "**byre** " BYRE_VERSION, "barns.yaml", "seeds 0, 1, 2", "2 cores; pace paced",
                           "mean / median / worst", "SE(3)", "only the map is aligned", "120", "118 poses"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
  EXPECT_THAT(text, Not(HasSubstr("stopped early")));
}

TEST(BenchmarkMarkdown, ShowsMeanMedianAndWorst) {
  const std::string text = to_markdown(result(), protocol(), kSetting);
  EXPECT_THAT(text, HasSubstr("| b*   | localise only | 80.0 / 90.0 / 50.0 |"));
  EXPECT_THAT(text, HasSubstr("| 7.0 / 6.0 / 10.0 |"));
}

TEST(BenchmarkMarkdown, ShowsPublishedFigures) {
  const std::string text = to_markdown(result(), protocol(), kSetting);
  EXPECT_THAT(text, HasSubstr("| b*   | *Others*      | –"));
  EXPECT_THAT(text, HasSubstr("| 11.9 "));
  EXPECT_THAT(text, HasSubstr("- *Others*: As printed."));
  EXPECT_THAT(text, Not(HasSubstr("Elsewhere")));
}

TEST(BenchmarkMarkdown, OmitsEmptyColumnsAndTables) {
  BenchmarkResult only_maps = result();
  EXPECT_THAT(to_markdown(only_maps, protocol(), kSetting), Not(HasSubstr("RPE 1 m mm")));
  only_maps.cases.clear();
  EXPECT_THAT(to_markdown(only_maps, protocol(), kSetting), Not(HasSubstr("## Final poses")));
}

TEST(BenchmarkMarkdown, ShowsTheNumberOfRunsOfAFigure) {
  BenchmarkResult partly = result();
  partly.cases[0].arms[0].runs[2].measures.final_poses.map_error.reset();
  EXPECT_THAT(to_markdown(partly, protocol(), kSetting), HasSubstr("5.5 / 5.5 / 6.0 (2 of 3)"));
}

TEST(BenchmarkMarkdown, ShowsOneFigureIfRunsAgree) {
  EXPECT_THAT(to_markdown(result(), protocol(), kSetting), HasSubstr("| b*   | localise only | 14.2         |"));
}

TEST(BenchmarkMarkdown, ShowsOneFigureForOneRun) {
  BenchmarkResult once = result();
  once.cases[0].arms[0].runs.resize(1);
  EXPECT_THAT(to_markdown(once, protocol(), kSetting), HasSubstr("| 100.0      |"));
}

TEST(BenchmarkMarkdown, ListsMissingCases) {
  BenchmarkResult stopped = result();
  stopped.stopped = true;
  const std::string text = to_markdown(stopped, protocol(), kSetting);
  EXPECT_THAT(text, HasSubstr("- c: /data/c does not exist"));
  EXPECT_THAT(text, HasSubstr("stopped early"));
}

TEST(BenchmarkMarkdown, EscapesControlCharactersOfNames) {
  BenchmarkSetting setting = kSetting;
  setting.data =
      "/data\x1b\xc2\x9b"
      "2J";
  const std::string text = to_markdown(result(), protocol(), setting);
  EXPECT_THAT(text, HasSubstr("recordings in /data\\x1b\\xc2\\x9b2J\n"));
}

TEST(BenchmarkJson, ContainsEveryRunAndItsSummary) {
  const auto json = nlohmann::json::parse(to_json(result(), protocol(), kSetting));
  EXPECT_EQ(json["protocol"]["seeds"], nlohmann::json({0, 1, 2}));
  EXPECT_EQ(json["protocol"]["version"], BYRE_VERSION);
  EXPECT_EQ(json["maps"][0]["alignment_poses"], 118);
  const auto& arm = json["cases"][0]["arms"][0];
  EXPECT_EQ(arm["arm"], "localise_only");
  EXPECT_EQ(arm["summary"]["final"]["map_error_m"]["median"], 0.006);
  EXPECT_EQ(arm["summary"]["final"]["map_error_m"]["worst"], 0.010);
  EXPECT_EQ(arm["summary"]["final"]["coverage"]["worst"], 0.5);
  EXPECT_TRUE(arm["summary"]["causal"]["ate_m"].is_null());
  ASSERT_THAT(arm["runs"], SizeIs(3));
  EXPECT_EQ(arm["runs"][2]["seed"], 2);
  EXPECT_EQ(arm["runs"][2]["warnings"][0], "torn image");
  EXPECT_EQ(arm["runs"][0]["behaviour"]["losses"], 1.0);
  EXPECT_TRUE(arm["runs"][0]["cost"]["peak_memory_mb"].is_null());
  EXPECT_EQ(json["cases"][0]["published"][0]["final"]["map_error_m"], 0.0119);
  EXPECT_EQ(json["skipped"][0]["name"], "c");
  EXPECT_EQ(json["stopped_early"], false);
}

}  // namespace
}  // namespace byre
