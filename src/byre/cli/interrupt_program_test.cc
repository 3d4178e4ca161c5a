// Outputs of a run that is interrupted or killed, or that cannot write.

#include "byre/base/sanitizer_scene.h"
#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::SizeIs;

class InterruptedProgram : public ProgramTest {
 protected:
  // Waits half a minute at most.
  bool comes_to_be(const std::string& file) const {
    for (int i = 0; i < 3000 && !fs::exists(folder_ / file); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return fs::exists(folder_ / file);
  }
};

TEST_F(InterruptedProgram, StopsAndWritesAllOutputs) {
  const RenderedFixture slow("byre_slow_room", 2, 1.0 / 3600.0);  // live; the second frame is due in an hour
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    for (const char* const file : {"room.byre", "final.txt", "causal.txt", "stats.json", "stderr.txt"}) {
      fs::remove(folder_ / file);
    }
    const pid_t process =
        start({"map", slow.folder().string(), "--pace", "live", "-o", (folder_ / "room.byre").string(), "--trajectory",
               (folder_ / "final.txt").string(), "--causal-trajectory", (folder_ / "causal.txt").string(), "--stats",
               (folder_ / "stats.json").string()});
    ASSERT_GT(process, 0);
    EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
    kill(process, signal);
    EXPECT_EQ(exit_code_of(process), 128 + signal);
    EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(1));
    EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(1));
    EXPECT_EQ(json::parse(read("stats.json")).at("stopped_early"), true);
    EXPECT_THAT(read("stdout.txt"), HasSubstr("2 frames, stopped after 1\n"));
    EXPECT_THAT(read("stdout.txt"), HasSubstr("finishing    skipped; run \"byre refine\"\n"));
    EXPECT_EQ(load_map(folder_ / "room.byre").map.keyframe_count(), 1);
  }
}

TEST_F(InterruptedProgram, IgnoresHangupUnderNohup) {
  const RenderedFixture slow("byre_nohup_room", 2, 1.0 / 3600.0);
  const auto before = std::signal(SIGHUP, SIG_IGN);
  const pid_t process = start({"map", slow.folder().string(), "--pace", "live", "-o", (folder_ / "room.byre").string()},
                              {SIGINT, SIGTERM});
  std::signal(SIGHUP, before);
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
  kill(process, SIGHUP);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(fs::exists(folder_ / "room.byre"));
  kill(process, SIGTERM);
  EXPECT_EQ(exit_code_of(process), 128 + SIGTERM);
  EXPECT_EQ(load_map(folder_ / "room.byre").map.keyframe_count(), 1);
}

TEST_F(InterruptedProgram, WritesTheOtherFilesIfOneIsTooLarge) {
  const RenderedFixture small("byre_small_room", 2, 20.0);
  const std::string command = "ulimit -f 8; cd '" + folder_.string() + "' && '" + BYRE_PROGRAM + "' map '" +
                              small.folder().string() +
                              "' -o room.byre --trajectory final.txt >stdout.txt 2>stderr.txt";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
  EXPECT_THAT(read("stderr.txt"),
              HasSubstr("room.byre: cannot be written: File too large (raise the limit of file sizes "
                        "(ulimit -f))"));
  EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(2));
  EXPECT_FALSE(has_unfinished_files());
}

TEST_F(InterruptedProgram, WritesAllOutputsWithAClosedStandardOutput) {
  const RenderedFixture small("byre_unheard_room", 2, 20.0);
  const std::string command = "cd '" + folder_.string() + "' && { sleep 0.2; '" + BYRE_PROGRAM + "' map '" +
                              small.folder().string() +
                              "' -o room.byre --trajectory final.txt; echo $? >code.txt; } 2>&1 | true";
  EXPECT_EQ(std::system(command.c_str()), 0);
  EXPECT_TRUE(appears("1\n", "code.txt"));  // reports that the result could not be written
  EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(2));
  EXPECT_GT(load_map(folder_ / "room.byre").map.keyframe_count(), 0);
}

TEST_F(InterruptedProgram, WarnsOfUnwrittenEventsAndFailsAtTheEnd) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  const RenderedFixture small("byre_eventful_room", 8, 20.0);
  const Outcome full = run("run '" + small.folder().string() + "' --events /dev/full --trajectory final.txt");
  EXPECT_EQ(full.exit_code, 1);
  const std::string warning = "byre: warning: events were not written: /dev/full: cannot be written: No space left";
  EXPECT_THAT(full.errors, HasSubstr(warning));
  EXPECT_LT(full.errors.find(warning), full.errors.find("8 of 8 frames"));
  EXPECT_THAT(full.errors, HasSubstr("byre: error: events were not written: /dev/full"));
  EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(8));

  // Localised after some frames; the map being in view is a different event.
  EXPECT_EQ(run("map '" + small.folder().string() + "' -o known.byre").exit_code, 0);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  const std::string reading = "cd '" + folder_.string() + "' && head -c 1 pipe >/dev/null &";
  EXPECT_EQ(std::system(reading.c_str()), 0);
  const Outcome closed = run("run '" + small.folder().string() + "' --map known.byre --events pipe --stats stats.json");
  EXPECT_EQ(closed.exit_code, 1);
  EXPECT_THAT(closed.errors, HasSubstr("byre: warning: events were not written: pipe: cannot be written: Broken"));
  EXPECT_EQ(json::parse(read("stats.json")).at("frames").size(), 8u);
}

TEST_F(InterruptedProgram, EndsAtOnceAtTheSecondCtrlCWithoutBrokenFiles) {
  if (kHasThreadSanitizer) GTEST_SKIP() << "the thread sanitizer delays signals while a thread opens a pipe";
  const RenderedFixture slow("byre_twice_stopped_room", 2, 1.0 / 3600.0);
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // without a reader, so writing blocks
  const pid_t process = start({"map", slow.folder().string(), "--pace", "live", "-o", (folder_ / "room.byre").string(),
                               "--trajectory", pipe.string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_TRUE(comes_to_be("room.byre"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_FALSE(has_unfinished_files());
  EXPECT_EQ(load_map(folder_ / "room.byre").map.keyframe_count(), 1);
}

TEST_F(InterruptedProgram, LeavesTheLastSavedMapWhenKilled) {
  const RenderedFixture ticking("byre_ticking_room", 12, 2.0);
  const pid_t process = start({"map", ticking.folder().string(), "--pace", "live", "--autosave", "0.1", "-o",
                               (folder_ / "room.byre").string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(comes_to_be("room.byre"));
  kill(process, SIGKILL);
  EXPECT_EQ(exit_code_of(process), -1) << "it ended before it was killed";
  const StoredMap stored = load_map(folder_ / "room.byre");
  EXPECT_GE(stored.map.keyframe_count(), 1);
  EXPECT_THAT(stored.recordings, SizeIs(1));
  EXPECT_NE(stored.vocabulary_checksum, 0u);
}

}  // namespace
}  // namespace byre::cli
