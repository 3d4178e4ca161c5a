#include "byre/benchmark/benchmark_run.h"

#include "byre/input_error.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

// Runs protocols on the rendered room, with results in a temporary folder.
class BenchmarkRun : public testing::Test {
 protected:
  BenchmarkRun() {
    const fs::path& folder = RenderedFixture::shared().folder();
    options_.data = folder.parent_path();
    options_.output = fs::path(testing::TempDir()) / ("byre_benchmark." + std::to_string(getpid()));
    options_.method.pace = Pace::same_thread;
    fs::create_directories(options_.output);
    protocol_.name = "room";
    protocol_.recordings = {{.name = "visit", .folder = folder.filename(), .range = {.last = 12}},
                            {.name = "map", .folder = folder.filename(), .range = {.last = 12}},
                            {.name = "absent", .folder = "byre_absent"}};
    protocol_.cases = {{"plain", "visit", {}, {Arm::no_map}}};
  }
  ~BenchmarkRun() override { fs::remove_all(options_.output); }

  BenchmarkResult run(int stop_after_runs = 1000) {
    BenchmarkHooks hooks;
    hooks.should_stop = [this, stop_after_runs] { return static_cast<int>(runs_done_) >= stop_after_runs; };
    hooks.before_run = [this](const std::string& what, int) { started_runs_.push_back(what); };
    hooks.after_frame = [](int, const PlayedFrame&) {};
    hooks.after_run = [this](const BenchmarkResult&) { ++runs_done_; };
    hooks.on_skipped = [](const SkippedCase&) {};
    return run_benchmark(protocol_, options_, hooks);
  }

  BenchmarkProtocol protocol_;
  BenchmarkOptions options_;
  std::vector<std::string> started_runs_;
  int runs_done_ = 0;
};

TEST_F(BenchmarkRun, MeasuresEachRunOfACase) {
  protocol_.runs = 2;
  protocol_.seeds = {5};
  const BenchmarkResult result = run();
  ASSERT_THAT(result.cases, SizeIs(1));
  ASSERT_THAT(result.cases[0].arms, SizeIs(1));
  const ArmResult& arm = result.cases[0].arms[0];
  ASSERT_THAT(arm.runs, SizeIs(2));
  EXPECT_EQ(arm.runs[0].seed, 5u);
  EXPECT_EQ(arm.runs[1].seed, 6u);
  for (const RunMeasures& measures : arm.measures()) {
    EXPECT_EQ(measures.final_poses.coverage, 1.0);
    EXPECT_LT(measures.final_poses.ate.value(), 0.1);
    EXPECT_GT(measures.cost.cpu_seconds.value(), 0.0);
    EXPECT_FALSE(measures.final_poses.map_error);
  }
  EXPECT_THAT(arm.final_trace, SizeIs(12));
  EXPECT_THAT(result.cases[0].truth, SizeIs(12));
  EXPECT_THAT(started_runs_, ElementsAre("plain no_map, run 1 of 2", "plain no_map, run 2 of 2"));
  EXPECT_FALSE(result.stopped);
}

TEST_F(BenchmarkRun, MakesAMapOnceForAllCasesOnIt) {
  protocol_.cases = {{"one*", "visit", "map", {Arm::localise_only, Arm::hybrid}},
                     {"two*", "visit", "map", {Arm::hybrid}}};
  const BenchmarkResult result = run();
  EXPECT_THAT(started_runs_, ElementsAre("map of map", "one* localise_only, run 1 of 1", "one* hybrid, run 1 of 1",
                                         "two* hybrid, run 1 of 1"));
  ASSERT_THAT(result.maps, SizeIs(1));
  EXPECT_GT(result.maps[0].keyframes, 1);
  EXPECT_TRUE(fs::is_regular_file(result.maps[0].file));
  EXPECT_TRUE(fs::is_regular_file(options_.output / "trajectories" / "one-star.hybrid.1.causal.txt"));
}

TEST_F(BenchmarkRun, SkipsCasesWithoutRecordings) {
  protocol_.cases.push_back({"far", "absent", {}, {Arm::no_map}});
  protocol_.cases.push_back({"far*", "visit", "absent", {Arm::hybrid}});
  const BenchmarkResult result = run();
  EXPECT_THAT(result.cases, SizeIs(1));
  ASSERT_THAT(result.skipped, SizeIs(2));
  EXPECT_EQ(result.skipped[1].name, "far*");
  EXPECT_THAT(result.skipped[1].reason, HasSubstr("byre_absent does not exist"));
}

TEST_F(BenchmarkRun, RejectsAnEmptySelection) {
  protocol_.cases = {{"far", "absent", {}, {Arm::no_map}}};
  try {
    run();
    FAIL() << "no InputError";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("contains none of the recordings of room"));
    EXPECT_THAT(error.remedy(), HasSubstr("--data"));
  }
}

TEST_F(BenchmarkRun, RunsOnlySelectedCases) {
  protocol_.cases.push_back({"again", "visit", {}, {Arm::no_map}});
  options_.only = {"again"};
  EXPECT_THAT(run().cases, SizeIs(1));
  EXPECT_THAT(started_runs_, ElementsAre("again no_map, run 1 of 1"));
  options_.only = {"other"};
  EXPECT_THROW(run(), InputError);
}

TEST_F(BenchmarkRun, KeepsMeasurementsWhenStopped) {
  protocol_.runs = 3;
  protocol_.cases.push_back({"again", "visit", {}, {Arm::no_map}});
  const BenchmarkResult result = run(2);
  EXPECT_TRUE(result.stopped);
  ASSERT_THAT(result.cases, SizeIs(1));
  EXPECT_THAT(result.cases[0].arms[0].runs, SizeIs(2));
}

TEST_F(BenchmarkRun, RejectsUnreadableTruthBeforeRunning) {
  protocol_.recordings[0].truth = "absent.txt";
  EXPECT_THROW(run(), InputError);
  EXPECT_THAT(started_runs_, SizeIs(0));
}

TEST_F(BenchmarkRun, AppliesTheTimeOffsetToTheTruth) {
  protocol_.recordings[0].truth_offset = std::chrono::seconds(1000);
  const BenchmarkResult result = run();
  EXPECT_THAT(result.cases[0].truth, SizeIs(0));
  EXPECT_FALSE(result.cases[0].arms[0].runs[0].measures.final_poses.ate);
}

TEST(FileName, IsPlain) {
  EXPECT_EQ(file_name_of("mh_02*"), "mh_02-star");
  EXPECT_EQ(file_name_of("a/b c"), "a-b-c");
}

}  // namespace
}  // namespace byre
