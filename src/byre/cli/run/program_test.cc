// "byre run": exit codes, stdout and stderr, output files.

#include "byre/alignment.h"
#include "byre/cli/shared/program_fixture.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/scaled_copy.h"
#include "byre/odometry/odometry_calibration.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/slam/frame/state.h"
#include "byre/trajectory_file.h"

#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

class RunProgram : public ProgramTest {
 protected:
  Outcome run_room(const std::string& arguments) const { return run("run " + rendered_room() + " " + arguments); }

  std::vector<json> lines_of(const std::string& file) const {
    std::istringstream text(read(file));
    std::vector<json> lines;
    for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line));
    return lines;
  }
};

TEST_F(RunProgram, PrintsHelp) {
  const Outcome help = run("run --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, AllOf(HasSubstr("--localise-only"), HasSubstr("--events"), HasSubstr("--map-truth"),
                                 HasSubstr("Examples:\n  byre run evening_round --map barn.byre")));
  EXPECT_THAT(run("--help").output, HasSubstr("  run "));
}

TEST_F(RunProgram, EqualsMappingWithoutAMap) {
  ASSERT_EQ(
      run("map " + rendered_room() + " --trajectory a.txt --causal-trajectory b.txt -o map.byre --quiet").exit_code, 0);
  const Outcome outcome = run_room("--trajectory c.txt --causal-trajectory d.txt --save-online run.byre --quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_THAT(outcome.output, testing::Not(HasSubstr("faults"))) << "the map is finished";
  EXPECT_EQ(read("a.txt"), read("c.txt"));
  EXPECT_EQ(read("b.txt"), read("d.txt"));
  EXPECT_EQ(read("map.byre"), read("run.byre"));
}

TEST_F(RunProgram, AlignsPosesToTheTruthWithoutAMap) {
  const Outcome outcome = run_room("--stats stats.json --truth " + rendered_room());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("truth        causal and final poses are aligned to it separately\n"));
  const json stats = json::parse(read("stats.json"));
  EXPECT_EQ(stats.at("protocol").at("program"), "byre run");
  EXPECT_EQ(stats.at("errors").at("final").at("count"), 24);
  EXPECT_LT(stats.at("errors").at("final").at("position_m").at("max"), 0.1);
  EXPECT_LT(stats.at("frames").at(5).at("error").at("position_m"), 0.1);
}

TEST_F(RunProgram, WritesTrajectoriesInTheRequestedFormat) {
  const Outcome outcome = run_room("--quiet --frames 0:6 --format euroc --trajectory a.csv --causal-trajectory b.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr(" m, through 6 final poses\n"));
  for (const char* const file : {"a.csv", "b.csv"}) {
    EXPECT_EQ(guess_trajectory_format(folder_ / file), TrajectoryFormat::euroc);
    EXPECT_THAT(read_trajectory(folder_ / file), SizeIs(6));
  }
}

TEST_F(RunProgram, AppliesTheTimeOffsetOfTheTruth) {
  const auto worst = [this](const std::string& options) {
    EXPECT_EQ(run_room("--quiet --stats stats.json " + options).exit_code, 0);
    return json::parse(read("stats.json")).at("errors").at("final").at("position_m").at("max").get<double>();
  };
  Trajectory late = RenderedFixture::shared().truth();
  for (StampedPose& sample : late) sample.time += from_seconds(0.25);
  write_trajectory(late, folder_ / "late.txt");
  EXPECT_NEAR(worst("--truth late.txt --time-offset -0.25"), worst("--truth " + rendered_room()), 1e-6);
}

TEST_F(RunProgram, WritesEventsAsJsonLines) {
  ASSERT_EQ(run_room("--frames 0:6 --events events.jsonl --quiet").exit_code, 0);
  const std::vector<json> lines = lines_of("events.jsonl");
  ASSERT_GE(lines.size(), 2u);
  EXPECT_EQ(lines.front().at("frame"), 0);
  EXPECT_EQ(lines.front().at("time_ns"), RenderedFixture::shared().truth().front().time.count());
}

TEST_F(RunProgram, RejectsWrongUsage) {
  for (const char* const arguments :
       {"--localise-only", "--map-truth truth.txt", "--map room.byre --map-truth truth.txt", "--pace fast",
        "--map room.byre --localise-only --save-online online.byre", "--map room.byre --save-online ./room.byre",
        "--events out.txt --stats ./out.txt", "--frames 9:3", "another_recording"}) {
    const Outcome outcome = run_room(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: ")) << arguments;
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
  EXPECT_EQ(run("run").exit_code, 2);
}

TEST_F(RunProgram, NamesBadInput) {
  write("torn.byre", "BYRE");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"absent", "byre: error: absent: is not a folder"},
      {rendered_room() + " --map absent.byre", "byre: error: absent.byre: "},
      {rendered_room() + " --map torn.byre", "byre: error: torn.byre: "},
      {rendered_room() + " --truth absent.txt", "byre: error: absent.txt: "},
      {rendered_room() + " --events nowhere/events.jsonl", "byre: error: nowhere/events.jsonl: cannot be written"},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("run " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
  }
}

TEST_F(RunProgram, KeepsResultsAtCtrlC) {
  const RenderedFixture slow("byre_slow_mission", 2, 1.0 / 3600.0);  // live; the second frame is due in an hour
  const pid_t process =
      start({"run", slow.folder().string(), "--pace", "live", "--save-online", (folder_ / "online.byre").string(),
             "--events", (folder_ / "events.jsonl").string(), "--causal-trajectory", (folder_ / "causal.txt").string(),
             "--stats", (folder_ / "stats.json").string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
  EXPECT_THAT(lines_of("events.jsonl"), testing::Not(IsEmpty())) << "during the run, not at the end";
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(1));
  EXPECT_EQ(json::parse(read("stats.json")).at("stopped_early"), true);
  EXPECT_EQ(load_map(folder_ / "online.byre").map.keyframe_count(), 1);
}

// Every other frame of the room is mapped; the rest is the mission.
class MissionProgram : public RunProgram {
 protected:
  MissionProgram() { map_room("--stride 2", "room.byre"); }

  Outcome mission(const std::string& arguments) const {
    return run_room("--map room.byre --frames 1: --stride 2 " + arguments);
  }
};

TEST_F(MissionProgram, LeavesTheMapFileUnchanged) {
  const std::string before = read("room.byre");
  const Outcome outcome =
      mission("--trajectory final.txt --stats stats.json --events events.jsonl --save-online online.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(read("room.byre"), before);
  EXPECT_THAT(outcome.output, HasSubstr("offline map  room.byre, "));
  EXPECT_EQ(json::parse(read("stats.json")).at("protocol").at("offline_map"), "room.byre");
}

TEST_F(MissionProgram, PublishesPosesInTheMapFrame) {
  const Outcome outcome = mission("--causal-trajectory causal.txt --stats stats.json --truth " + rendered_room());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(12));
  EXPECT_THAT(outcome.output, HasSubstr("truth        aligned to the map by "));
  const json errors = json::parse(read("stats.json")).at("errors");
  EXPECT_LT(errors.at("causal").at("position_m").at("max"), 0.05);
  EXPECT_EQ(errors.at("trusted_off_by_more_than_0.2m"), 0);
}

TEST_F(MissionProgram, PublishesPosesOnThePlan) {
  StoredMap stored = load_map(folder_ / "room.byre");
  stored.plan.emplace();
  stored.plan->plan = "plan.yaml";
  stored.plan->plan_from_map.target_from_source = {rotation_exp({0.0, 0.0, 2.0}), {1000.0, 2000.0, 0.0}};
  save_map(stored, folder_ / "room.byre");
  ASSERT_EQ(mission("--causal-trajectory map.txt --odometry a.txt --quiet").exit_code, 0);
  const Outcome outcome = mission(
      "--frame plan --causal-trajectory plan.txt --odometry b.txt --events events.jsonl --stats stats.json --truth " +
      rendered_room());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("; poses on the plan plan.yaml\n"));
  const Pose in_map = read_trajectory(folder_ / "map.txt").back().world_from_body;
  const Pose on_plan = read_trajectory(folder_ / "plan.txt").back().world_from_body;
  EXPECT_THAT(on_plan, PoseNear(stored.plan->plan_from_map.target_from_source * in_map, 1e-6, 1e-6));
  EXPECT_EQ(read("a.txt"), read("b.txt")) << "odometry has its own frame";
  const json stats = json::parse(read("stats.json"));
  EXPECT_EQ(stats.at("protocol").at("pose_frame"), "plan");
  EXPECT_NEAR(stats.at("frames").back().at("position_m").at(1), on_plan.translation.y(), 1e-6);
  EXPECT_LT(stats.at("errors").at("causal").at("position_m").at("max"), 0.05) << "errors are still in the map frame";
  EXPECT_GT(lines_of("events.jsonl").back().at("position_m").at(1), 1900.0);
}

TEST_F(MissionProgram, ReportsUnusedWallsOfThePlan) {
  write("plan.yaml", "image: plan.pgm\nresolution: 0.1\norigin: [0, 0, 0]\n");
  write("plan.pgm", "P2 2 2 255\n255 255 255 255\n");
  StoredMap stored = load_map(folder_ / "room.byre");
  stored.plan.emplace();
  stored.plan->plan = "plan.yaml";
  save_map(stored, folder_ / "room.byre");
  const Outcome outcome = mission("--plan plan.yaml --quiet");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("plan.yaml: its walls are not used: it has no occupied_thresh"));
}

// State after a scale correction on a floor plan: the recording still has the original baseline.
TEST_F(MissionProgram, UsesTheBaselineOfTheMap) {
  constexpr double kFactor = 0.95;
  ASSERT_EQ(mission("--causal-trajectory before.txt --quiet").exit_code, 0);
  const StoredMap stored = load_map(folder_ / "room.byre");
  save_map(scaled_copy(stored, kFactor), folder_ / "room.byre");
  ASSERT_EQ(mission("--causal-trajectory now.txt --stats stats.json --quiet").exit_code, 0);
  const auto last_camera = [&](const std::string& file) {
    return read_trajectory(folder_ / file).back().world_from_body * stored.map.rigs()[0].body_from_camera;
  };
  EXPECT_THAT(last_camera("now.txt"), PoseNear(scale_lengths(last_camera("before.txt"), kFactor), 0.002, 0.001));
  EXPECT_EQ(json::parse(read("stats.json")).at("frames").back().at("health").at("verdict"), "trusted");
}

TEST_F(MissionProgram, FailsIfManyFramesAreMissing) {
  const RenderedFixture& room = RenderedFixture::shared();
  fs::copy(room.folder(), folder_ / "torn", fs::copy_options::recursive);
  for (const std::size_t frame : {15, 17, 19})
    fs::remove(folder_ / "torn" / fs::relative(room.image("cam0", frame), room.folder()));
  const Outcome outcome =
      run("run torn --map room.byre --frames 1: --stride 2 --stats stats.json --causal-trajectory causal.txt");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("byre: error: 3 of 12 frames could not be read, see the warnings: "));
  EXPECT_THAT(outcome.errors, HasSubstr(".png: does not exist"));
  EXPECT_THAT(outcome.output, HasSubstr("missing 25.0 % of 12 frames\n"));
  EXPECT_EQ(json::parse(read("stats.json")).at("mission").at("frames_missing"), 3);
  EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(9)) << "all files are written";
}

TEST_F(MissionProgram, EndsTrustedAndWritesEvents) {
  ASSERT_EQ(mission("--events events.jsonl --stats stats.json").exit_code, 0);
  std::vector<std::string> events;
  for (const json& line : lines_of("events.jsonl")) events.push_back(line.at("event"));
  EXPECT_THAT(events, Contains("localised"));
  const json last = json::parse(read("stats.json")).at("frames").back();
  EXPECT_EQ(last.at("health").at("verdict"), "trusted");
  EXPECT_GE(last.at("health").at("offline_inliers"), OfflineViewOptions{}.min_inliers);
  EXPECT_GT(json::parse(read("stats.json")).at("mission").at("in_known_places").at("minutes"), 0.0);
}

TEST_F(MissionProgram, WritesOdometryPoses) {
  ASSERT_EQ(mission("--odometry odometry.txt --stats stats.json").exit_code, 0);
  const Trajectory odometry = read_trajectory(folder_ / "odometry.txt");
  ASSERT_THAT(odometry, SizeIs(12));
  EXPECT_LT(odometry.front().world_from_body.translation.norm(), 1e-6) << "it begins at the start of the robot";
  EXPECT_EQ(json::parse(read("stats.json")).at("frames").back().at("odometry").at("body_covariance").size(), 36u);
}

TEST_F(MissionProgram, MapsNothingWithLocaliseOnly) {
  const Outcome outcome = mission("--localise-only --stats stats.json --causal-trajectory causal.txt");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("no online mapping"));
  const json counts = json::parse(read("stats.json")).at("counts");
  EXPECT_EQ(counts.at("keyframes_made"), 0);
  EXPECT_EQ(counts.at("frames_with_pose"), 12);
}

TEST_F(MissionProgram, SavesTheOnlineMap) {
  map_room("--frames 0:6", "corner.byre");
  const Outcome outcome = run_room("--map corner.byre --frames 3: --save-online online.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_EQ(run("validate online.byre").exit_code, 0);
  const Outcome found = run("localise online.byre " + rendered_room() + " --frames 20:");
  EXPECT_THAT(found.output, HasSubstr("found        4 of 4 frames"));
}

TEST_F(MissionProgram, StoresWheelExtrinsicsInTheSavedMap) {
  map_room("--frames 0:6", "corner.byre");
  StoredMap stored = load_map(folder_ / "corner.byre");
  OdometryCalibration known;
  known.wheels.emplace().metres_per_unit = 1.02;
  write_odometry_calibration(known, stored.notes);
  save_map(stored, folder_ / "corner.byre");
  ASSERT_EQ(run_room("--map corner.byre --frames 3: --save-online online.byre").exit_code, 0);
  EXPECT_EQ(load_map(folder_ / "online.byre").notes, stored.notes);
}

TEST_F(MissionProgram, FailsInAnotherRoomAndPrintsAReport) {
  RenderedRoomOptions other;
  other.seed = 99;
  const Calibration calibration = euroc_like_calibration(4);
  write_euroc_recording(RenderedRoom(other), calibration,
                        figure_eight_trajectory(6, 20.0, 3.0, 0.05, calibration.body_from_left), folder_ / "elsewhere",
                        {});
  const Outcome outcome = run("run elsewhere --map room.byre --localise-only --stats stats.json");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("byre: error: no frame was localised in room.byre"));
  EXPECT_EQ(json::parse(read("stats.json")).at("mission").at("frames_trusted"), 0);
}

}  // namespace
}  // namespace byre::cli
