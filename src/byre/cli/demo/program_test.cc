// "byre demo" on a few small images.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/trajectory_file.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::SizeIs;
using testing::StartsWith;

class DemoProgram : public ProgramTest {};

TEST_F(DemoProgram, WritesAPageAndItsData) {
  const Outcome outcome = run("demo -o out --duration 8 --rate 4 --divide 2 --animation film.png");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("Frames with a position on the plan, %"),
                                    HasSubstr("page         out/index.html\n"), HasSubstr("animation    film.png\n")));
  EXPECT_THAT(outcome.errors,
              AllOf(HasSubstr("1 of 6: rendering"), HasSubstr("6 of 6: the second visit: Localise only\n")));

  const std::string page = read("out/index.html");
  EXPECT_THAT(page, AllOf(StartsWith("<!DOCTYPE html>"), HasSubstr("<table id=\"arms\">")));
  EXPECT_THAT(page, AllOf(HasSubstr("<figure id=\"mission\">"), HasSubstr("<svg class=\"timeline\"")));
  EXPECT_THAT(page, Not(HasSubstr("http://")));

  const StoredMap stored = load_map(folder_ / "out" / "barn.byre");
  ASSERT_TRUE(stored.plan);
  EXPECT_EQ(stored.plan->plan, "plan.yaml");
  EXPECT_THAT(read_trajectory(folder_ / "out" / "trajectories" / "first_visit.final.txt"), SizeIs(32));
  EXPECT_THAT(read("out/plan.svg"), StartsWith("<svg"));
  EXPECT_THAT(read("out/mission.svg"), AllOf(StartsWith("<svg"), HasSubstr("never on the plan")));
  EXPECT_THAT(read("out/mission.png"), StartsWith("\x89PNG"));
  EXPECT_THAT(read("film.png"), AllOf(StartsWith("\x89PNG"), HasSubstr("acTL"), HasSubstr("fdAT")));
}

TEST_F(DemoProgram, DoesNotOverwriteADemonstration) {
  fs::create_directories(folder_ / "byre_demo" / "first_visit" / "mav0");
  const Outcome outcome = run("demo");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, StartsWith("byre: error: byre_demo: already contains a demonstration"));
}

TEST_F(DemoProgram, StopsAtCtrlCWithoutAPage) {
  const pid_t process = start({"demo", "-o", (folder_ / "out").string(), "--divide", "8"});
  ASSERT_GT(process, 0);
  EXPECT_TRUE(appears("rendering", "stderr.txt"));
  kill(process, SIGINT);
  EXPECT_EQ(exit_code_of(process), 130);
  EXPECT_FALSE(fs::exists(folder_ / "out" / "index.html"));
  EXPECT_THAT(read("stdout.txt"), IsEmpty());
}

TEST_F(DemoProgram, RejectsWrongUsage) {
  EXPECT_EQ(run("demo --duration 0").exit_code, 2);
  EXPECT_EQ(run("demo somewhere").exit_code, 2);
  EXPECT_EQ(run("demo --animation film.gif").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
