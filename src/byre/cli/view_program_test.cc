#include "byre/cli/program_fixture.h"
#include "byre/cli/rendered_fixture.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::MatchesRegex;
using ::testing::Not;

class ViewProgram : public ProgramTest {
 protected:
  const std::string room_ = RenderedFixture::shared().folder().string();

  void map_room() const { ASSERT_EQ(run("map '" + room_ + "' -o room.byre --quiet").exit_code, 0); }
};

TEST_F(ViewProgram, ShowsAMapUntilItIsInterrupted) {
  map_room();
  const pid_t process = start({"view", (folder_ / "room.byre").string(), "--port", "0"});
  ASSERT_TRUE(appears("until Ctrl-C", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_THAT(read("stderr.txt"), HasSubstr("viewer: http://127.0.0.1:"));
  EXPECT_THAT(read("stdout.txt"), IsEmpty());
}

TEST_F(ViewProgram, TellsOnlyItsAddressWhenQuiet) {
  map_room();
  const pid_t process =
      start({"view", (folder_ / "room.byre").string(), "--port", "0", "--bind", "0.0.0.0", "--quiet"});
  ASSERT_TRUE(appears("?token=", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0);
  EXPECT_THAT(read("stderr.txt"), MatchesRegex("viewer: http://127.0.0.1:[0-9]+/\\?token=[0-9a-f]+\n"));
}

TEST_F(ViewProgram, GoesOnShowingARunOnceItsFilesAreWritten) {
  const pid_t process = start({"run", room_, "--trajectory", (folder_ / "path.txt").string(), "--view", "0"});
  ASSERT_TRUE(appears("until Ctrl-C", "stderr.txt"));
  EXPECT_THAT(read("path.txt"), Not(IsEmpty()));
  EXPECT_THAT(read("stdout.txt"), HasSubstr("path.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 0);
}

TEST_F(ViewProgram, SaysWhatIsWrongWithItsOptions) {
  EXPECT_EQ(run("view nothing.byre").exit_code, 3);
  EXPECT_THAT(run("view a.byre --plan plan.yaml -o a.byre").errors, HasSubstr("--overwrite"));
  EXPECT_THAT(run("view a.byre -o b.byre").errors, HasSubstr("--plan"));
  EXPECT_THAT(run("view a.byre --port 70000").errors, HasSubstr("--port"));
  EXPECT_THAT(run("run '" + room_ + "' --view 0 --bind barn").errors, HasSubstr("is no IP address"));
  EXPECT_THAT(run("run '" + room_ + "' --view 0 --plan plan.yaml").errors, HasSubstr("--map"));
  EXPECT_THAT(run("run '" + room_ + "' --bind 127.0.0.1").errors, HasSubstr("--view"));
}

}  // namespace
}  // namespace byre::cli
