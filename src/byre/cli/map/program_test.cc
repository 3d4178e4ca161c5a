// "byre map": exit codes, stdout and stderr, output files.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/place/vocabulary.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <chrono>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

class MapProgram : public ProgramTest {
 protected:
  Outcome map(const std::string& arguments) const {
    return run("map " + quoted(RenderedFixture::shared().folder()) + " " + arguments);
  }

  auto files_left() const { return std::distance(fs::directory_iterator(folder_), {}); }
};

TEST_F(MapProgram, PrintsHelp) {
  const Outcome help = run("map --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, AllOf(HasSubstr("--causal-trajectory"), HasSubstr("--pace"), HasSubstr("--stride"),
                                 HasSubstr("Examples:\n  byre map MH_01_easy -o barn.byre\n")));
}

TEST_F(MapProgram, WritesTheRequestedOutputs) {
  const Outcome outcome = map("--trajectory final.txt --causal-trajectory causal.txt --stats stats.json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const std::size_t frames = RenderedFixture::shared().truth().size();
  EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(frames));
  EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(frames));
  EXPECT_EQ(json::parse(read("stats.json")).at("frames").size(), frames);
  EXPECT_THAT(outcome.output, HasSubstr("poses        24 of 24 frames (100.0 %)\n"));
  EXPECT_THAT(outcome.output, HasSubstr("written      final.txt, causal.txt, stats.json\n"));
  EXPECT_THAT(outcome.errors, HasSubstr("24 of 24 frames, "));
  EXPECT_THAT(outcome.errors, HasSubstr("finishing: searching for loops\n"));
  EXPECT_THAT(outcome.output, testing::Not(HasSubstr("faults")));
  EXPECT_EQ(json::parse(read("stats.json")).at("finishing").at("cut_short"), false);
  EXPECT_EQ(files_left(), 5) << "three results and the two streams";
}

TEST_F(MapProgram, SavesTheMapWithWordsAndOrigin) {
  const Outcome outcome = map("-o room.byre --site 'Test room' --quiet");
  EXPECT_EQ(outcome.exit_code, 0);
  const StoredMap stored = load_map(folder_ / "room.byre");
  EXPECT_GT(stored.map.keyframe_count(), 1);
  EXPECT_EQ(stored.vocabulary_checksum, Vocabulary::load(default_vocabulary_path()).checksum());
  EXPECT_EQ(stored.notes.at("site"), "Test room");
  ASSERT_THAT(stored.recordings, SizeIs(1));
  EXPECT_EQ(stored.recordings.front().name, RenderedFixture::shared().folder().filename());
  EXPECT_EQ(stored.recordings.front().last_time, RenderedFixture::shared().truth().back().time);
  EXPECT_THAT(outcome.output, HasSubstr("written      room.byre\n"));
}

TEST_F(MapProgram, SavesTheSameBytesForTheSameInput) {
  map_room("", "room.byre");
  ASSERT_EQ(map("-o again.byre --quiet").exit_code, 0);
  EXPECT_EQ(read("room.byre"), read("again.byre"));
}

TEST_F(MapProgram, UsesGivenPosesAndReportsThem) {
  const Outcome outcome = map("-o posed.byre --stride 4 --quiet --poses " + quoted(RenderedFixture::shared().folder()));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("not estimated"));
  const StoredMap stored = load_map(folder_ / "posed.byre");
  EXPECT_EQ(stored.pose_source, PoseSource::given);
  EXPECT_EQ(stored.map.keyframe_count(), 6);
}

TEST_F(MapProgram, MapsWithOneCameraOfAPair) {
  const Outcome outcome =
      map("-o right.byre --camera right --stride 4 --quiet --poses " + quoted(RenderedFixture::shared().folder()));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const StoredMap stored = load_map(folder_ / "right.byre");
  ASSERT_THAT(stored.recordings, SizeIs(1));
  EXPECT_FALSE(stored.recordings.front().calibration.right);
  EXPECT_GT(stored.map.point_count(), 100);
}

TEST_F(MapProgram, PrintsNoProgressWhenQuiet) {
  const Outcome outcome = map("--trajectory final.txt --frames 0:3 --quiet");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_THAT(outcome.output, StartsWith("recording    "));
}

TEST_F(MapProgram, SkipsLoopsAndFinishingOnRequest) {
  const Outcome outcome = map("-o room.byre --stats stats.json --no-loops");
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.errors, Not(HasSubstr("finishing")));
  EXPECT_THAT(outcome.output, HasSubstr("finishing    skipped"));
  EXPECT_TRUE(json::parse(read("stats.json")).at("finishing").is_null());
  EXPECT_NE(load_map(folder_ / "room.byre").vocabulary_checksum, 0u) << "place recognition works in the saved map";
}

TEST_F(MapProgram, MapsTheSelectedRange) {
  EXPECT_EQ(map("--trajectory frames.txt --frames 4:12 --stride 2 --pace inline").exit_code, 0);
  const Trajectory frames = read_trajectory(folder_ / "frames.txt");
  ASSERT_THAT(frames, SizeIs(4));
  EXPECT_EQ(frames.front().time, std::chrono::milliseconds(200));
  EXPECT_EQ(frames.back().time, std::chrono::milliseconds(500));

  EXPECT_EQ(map("--trajectory seconds.txt --start 0.1 --end 0.3 --pace live").exit_code, 0);
  const Trajectory seconds = read_trajectory(folder_ / "seconds.txt");
  ASSERT_THAT(seconds, SizeIs(4));
  EXPECT_EQ(seconds.front().time, std::chrono::milliseconds(100));
}

TEST_F(MapProgram, RejectsWrongUsage) {
  for (const char* const arguments : {"",
                                      "--poses truth.txt --trajectory out.txt",
                                      "-o map.byre --poses truth.txt --trajectory out.txt",
                                      "--trajectory",
                                      "--trajectory out.txt --frames 5",
                                      "--trajectory out.txt --frames 9:3",
                                      "--trajectory out.txt --start 2 --end 2",
                                      "--trajectory out.txt --start -1",
                                      "--trajectory out.txt --stride 0",
                                      "--trajectory out.txt --pace fast",
                                      "--trajectory out.txt --camera middle",
                                      "--trajectory out.txt --fps 0",
                                      "--trajectory out.txt --stats ./out.txt",
                                      "--trajectory out.txt another_recording",
                                      "--trajectory out.txt --autosave 10",
                                      "-o map.byre --autosave soon",
                                      "--trajectory out.txt --extend old.byre",
                                      "-o map.byre --extend ./map.byre",
                                      "-o map.byre --extend old.byre --no-loops",
                                      "-o map.byre --extend old.byre --poses truth.txt"}) {
    const Outcome outcome = map(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: ")) << arguments;
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
  EXPECT_EQ(run("map --trajectory out.txt").exit_code, 2);
}

TEST_F(MapProgram, NamesBadInput) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"absent --trajectory out.txt", "byre: error: absent: is not a folder"},
      {". --trajectory out.txt", "byre: error: .: contains no recording in a supported format"},
      {"absent --trajectory nowhere/out.txt",
       "byre: error: nowhere/out.txt: cannot be written: the folder does not exist"},
      {"absent --trajectory out.txt --stats .", "byre: error: .: is a folder"},
      {quoted(RenderedFixture::shared().folder()) + " --trajectory out.txt --frames 100:", "byre: error: "},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("map " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
}

TEST_F(MapProgram, FailsIfManyFramesCannotBeRead) {
  const RenderedFixture& room = RenderedFixture::shared();
  fs::copy(room.folder(), folder_ / "torn", fs::copy_options::recursive);
  for (std::size_t frame = 8; frame < 17; ++frame) {
    fs::resize_file(folder_ / "torn" / fs::relative(room.image("cam0", frame), room.folder()), 100);
  }
  for (const std::string poses : {"", " --poses torn"}) {
    const Outcome outcome = run("map torn -o torn.byre" + poses);
    EXPECT_EQ(outcome.exit_code, 1) << poses;
    EXPECT_THAT(outcome.errors, HasSubstr("byre: error: 9 of 24 frames could not be read, see the warnings: torn/"))
        << poses;
    EXPECT_THAT(outcome.errors, HasSubstr("(record or copy these images again, or exclude them with --frames)"))
        << poses;
    EXPECT_GT(load_map(folder_ / "torn.byre").map.keyframe_count(), 0) << "all files are written";
  }
}

TEST_F(MapProgram, ReportsWhyMonocularInitialisationFailed) {
  const Outcome outcome = map("--trajectory out.txt --camera left --frames 0:2");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.errors, HasSubstr("no frame got a pose: monocular initialisation needs sideways motion"));
}

TEST_F(MapProgram, FailsWithoutAnyPoseAndPrintsAReport) {
  const RenderedFixture blind("byre_blind_room", 2, 20.0);
  fs::remove(blind.image("cam1", 0));
  const Outcome outcome =
      run("map " + quoted(blind.folder()) + " --frames 0:1 -o map.byre --trajectory out.txt --stats stats.json");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_FALSE(fs::exists(folder_ / "map.byre"));
  EXPECT_THAT(outcome.errors, HasSubstr("byre: error: no frame got a pose"));
  EXPECT_THAT(outcome.errors, HasSubstr("byre: warning: "));
  EXPECT_EQ(json::parse(read("stats.json")).at("counts").at("frames_without_right_image"), 1);
}

}  // namespace
}  // namespace byre::cli
