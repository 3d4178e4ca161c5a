// What is left of "byre map" when it is interrupted or killed.

#include "byre/cli/program_fixture.h"
#include "byre/cli/rendered_fixture.h"
#include "byre/evaluation/trajectory_file.h"
#include "byre/map/map_file.h"

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
  // Gives up after half a minute.
  bool comes_to_be(const std::string& file) const {
    for (int i = 0; i < 3000 && !fs::exists(folder_ / file); ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return fs::exists(folder_ / file);
  }
};

TEST_F(InterruptedProgram, StopsAtCtrlCAndStillWritesEverything) {
  const RenderedFixture slow("byre_slow_room", 2, 1.0 / 3600.0);  // live, its second frame is due in an hour
  const pid_t process = start({"map", slow.folder().string(), "--pace", "live", "-o", (folder_ / "room.byre").string(),
                               "--trajectory", (folder_ / "final.txt").string(), "--causal-trajectory",
                               (folder_ / "causal.txt").string(), "--stats", (folder_ / "stats.json").string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_THAT(read_trajectory(folder_ / "final.txt"), SizeIs(1));
  EXPECT_THAT(read_trajectory(folder_ / "causal.txt"), SizeIs(1));
  EXPECT_EQ(json::parse(read("stats.json")).at("stopped_early"), true);
  EXPECT_THAT(read("stdout.txt"), HasSubstr("2 frames, stopped after 1\n"));
  EXPECT_THAT(read("stdout.txt"), HasSubstr("finishing    left out; \"byre refine\" does it\n"));
  EXPECT_EQ(load_map(folder_ / "room.byre").map.keyframe_count(), 1);
}

TEST_F(InterruptedProgram, EndsAtOnceAtTheSecondCtrlCAndLeavesNoBrokenFile) {
  const RenderedFixture slow("byre_twice_stopped_room", 2, 1.0 / 3600.0);
  const fs::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // nobody reads it, so writing it does not end
  const pid_t process = start({"map", slow.folder().string(), "--pace", "live", "-o", (folder_ / "room.byre").string(),
                               "--trajectory", pipe.string()});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("1 of 2 frames", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_TRUE(comes_to_be("room.byre"));
  write("room.byre.unfinished", "half of a map");
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_FALSE(fs::exists(folder_ / "room.byre.unfinished"));
  EXPECT_EQ(load_map(folder_ / "room.byre").map.keyframe_count(), 1);
}

TEST_F(InterruptedProgram, LeavesTheMapItSavedLastWhenItIsKilled) {
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
