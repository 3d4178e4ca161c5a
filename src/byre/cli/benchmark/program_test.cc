
#include "byre/cli/shared/program_fixture.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

class BenchmarkProgram : public ProgramTest {
 protected:
  BenchmarkProgram() {
    const fs::path& room = RenderedFixture::shared().folder();
    write("room.yaml", "title: A room\nrecordings:\n  - {name: room, folder: " + room.filename().string() +
                           ", frames: \"0:8\"}\n  - {name: hall, folder: hall}\ncases:\n"
                           "  - {name: room, recording: room}\n  - {name: hall*, recording: hall, map: room}\n");
    data_ = "--data '" + room.parent_path().string() + "'";
  }

  std::string data_;
};

TEST_F(BenchmarkProgram, WritesTablesFiguresAndPlots) {
  const Outcome outcome = run("benchmark room.yaml " + data_ + " -o out/first --runs 2");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("# A room"));
  EXPECT_THAT(outcome.output, HasSubstr("| room | no map | 100.0"));
  EXPECT_THAT(outcome.output, HasSubstr("- hall*: "));
  EXPECT_THAT(outcome.errors, HasSubstr("skipped hall*"));
  EXPECT_THAT(outcome.errors, HasSubstr("room no_map, run 2 of 2"));
  EXPECT_THAT(read("out/first/benchmark.md"), HasSubstr(outcome.output));
  EXPECT_THAT(read("out/first/benchmark.md"), HasSubstr("](room_error.svg)"));
  const auto parsed = nlohmann::json::parse(read("out/first/benchmark.json"));
  EXPECT_THAT(parsed["cases"][0]["arms"][0]["runs"], SizeIs(2));
  EXPECT_THAT(read("out/first/room_path.svg"), HasSubstr("</svg>"));
  EXPECT_TRUE(fs::exists(folder_ / "out/first/trajectories/room.no_map.2.final.txt"));
}

TEST_F(BenchmarkProgram, RepeatsResultsWithQuiet) {
  ASSERT_EQ(run("benchmark room.yaml " + data_ + " -o a --quiet").exit_code, 0);
  const Outcome again = run("benchmark room.yaml " + data_ + " -o b --quiet");
  EXPECT_THAT(again.errors, IsEmpty());
  EXPECT_FALSE(read("a/trajectories/room.no_map.1.final.txt").empty());
  EXPECT_EQ(read("a/trajectories/room.no_map.1.final.txt"), read("b/trajectories/room.no_map.1.final.txt"));
}

TEST_F(BenchmarkProgram, MeasuresALifeOfAMap) {
  fs::create_directory(folder_ / "life");
  for (const char* const day : {"day_1", "day_2", "day_3"}) {
    fs::create_directory_symlink(fs::absolute(RenderedFixture::shared().folder()), folder_ / "life" / day);
  }
  fs::create_directories(folder_ / "life/day_4.unfinished/mav0");  // is being rendered
  const Outcome outcome = run("benchmark --life life -o lived");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, HasSubstr("day_3, newest version"));
  EXPECT_THAT(outcome.output, HasSubstr("| day_2 | "));
  EXPECT_THAT(outcome.output, HasSubstr("Localised without a prediction, "));
  EXPECT_THAT(read("lived/life.md"), HasSubstr(outcome.output));
  const auto parsed = nlohmann::json::parse(read("lived/life.json"));
  ASSERT_THAT(parsed["days"], SizeIs(2));
  EXPECT_GT(parsed["days"][0]["first"]["trusted"], 0.5);
  EXPECT_EQ(parsed["days"][0]["newest"]["wrongly_trusted"], 0);
  EXPECT_THAT(read("lived/life.svg"), HasSubstr("Offline inliers"));
  EXPECT_TRUE(fs::exists(folder_ / "lived/first.byre"));

  const Outcome refused = run("benchmark --life lived");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.errors, HasSubstr("holds fewer than two recordings"));
}

TEST_F(BenchmarkProgram, MeasuresTheSpeedOfARecording) {
  const std::string room = "'" + RenderedFixture::shared().folder().string() + "'";
  const Outcome outcome = run("benchmark --speed " + room + " --frames 0:6 --runs 2 --pace paced -o speed");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("6 frames, 6 with a pose; without a map; pace paced"));
  EXPECT_THAT(outcome.output, HasSubstr("| stereo "));
  EXPECT_THAT(outcome.output, HasSubstr("| CPU time, s "));
  EXPECT_EQ(read("speed/speed.md"), outcome.output);
  const auto parsed = nlohmann::json::parse(read("speed/speed.json"));
  ASSERT_THAT(parsed["runs"], SizeIs(2));
  const auto& first = parsed["runs"][0];
  EXPECT_EQ(first["stages"]["frame"]["count"], 6);
  EXPECT_GT(first["stages"]["frame"]["mean_ms"], first["stages"]["extract"]["mean_ms"]);
  EXPECT_GT(first["first_pose_s"], 0.0);
  EXPECT_GT(first["wall_s"], first["first_pose_s"]);
}

TEST_F(BenchmarkProgram, AcceptsEitherAProtocolOrARecording) {
  const std::string room = "'" + RenderedFixture::shared().folder().string() + "'";
  EXPECT_EQ(run("benchmark room.yaml --speed " + room).exit_code, 2);
  EXPECT_EQ(run("benchmark --speed " + room + " --only room").exit_code, 2);
  EXPECT_EQ(run("benchmark room.yaml --stride 2").exit_code, 2);
  const Outcome neither = run("benchmark --runs 2");
  EXPECT_EQ(neither.exit_code, 2);
  EXPECT_THAT(neither.errors, HasSubstr("PROTOCOL, --speed or --life"));
}

TEST_F(BenchmarkProgram, ReportsFaultsOfItsInput) {
  EXPECT_EQ(run("benchmark").exit_code, 2);
  EXPECT_EQ(run("benchmark room.yaml --runs 0").exit_code, 2);
  const Outcome unknown = run("benchmark unknown");
  EXPECT_EQ(unknown.exit_code, 3);
  EXPECT_THAT(unknown.errors, HasSubstr("euroc, twin or mh_short"));
  const Outcome nothing = run("benchmark room.yaml --data .");
  EXPECT_EQ(nothing.exit_code, 3);
  EXPECT_THAT(nothing.errors, HasSubstr("contains none of the recordings of room"));
  write("broken.yaml", "cases: 1\nrunz: 2\n");
  EXPECT_THAT(run("benchmark broken.yaml").errors, HasSubstr("broken.yaml:2: unknown field \"runz\""));
}

TEST_F(BenchmarkProgram, KeepsMeasurementsWhenInterrupted) {
  const pid_t process = start({"benchmark", (folder_ / "room.yaml").string(), "--data",
                               RenderedFixture::shared().folder().parent_path().string(), "-o",
                               (folder_ / "out").string(), "--runs", "500"});
  ASSERT_TRUE(appears("run 3 of 500", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_THAT(read("stdout.txt"), HasSubstr("stopped early"));
  EXPECT_EQ(nlohmann::json::parse(read("out/benchmark.json"))["stopped_early"], true);
  EXPECT_GE(nlohmann::json::parse(read("out/benchmark.json"))["cases"][0]["arms"][0]["runs"].size(), 2u);
}

}  // namespace
}  // namespace byre::cli
