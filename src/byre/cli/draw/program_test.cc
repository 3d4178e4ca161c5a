// "byre draw": exit codes, messages, and content of the pictures.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/plan/occupancy_grid.h"
#include "byre/playback/archive/register_scene.h"
#include "byre/simulation/rendered_scene.h"

#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

constexpr const char* kPngBegin = "\x89PNG\r\n";

class DrawProgram : public ProgramTest {
 protected:
  DrawProgram() { map_room("--stride 2", "room.byre"); }

  // Every other frame is the mission.
  Outcome draw_mission(const std::string& arguments) const {
    return run("draw " + rendered_room() + " --map room.byre --frames 1: --stride 2 --quiet " + arguments);
  }
};

TEST_F(DrawProgram, PrintsHelp) {
  const Outcome help = run("draw --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output, AllOf(HasSubstr("--camera-picture"), HasSubstr("--video"), HasSubstr("--heights"),
                                 HasSubstr("Examples:\n  byre draw barn.byre -o barn.svg")));
  EXPECT_THAT(run("--help").output, HasSubstr("  draw "));
}

TEST_F(DrawProgram, DrawsAMapFromAbove) {
  const Outcome outcome = run("draw room.byre -o room.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(StartsWith("map          room.byre, "), HasSubstr("written      room.svg\n")));
  EXPECT_THAT(read("room.svg"), AllOf(StartsWith("<svg "), HasSubstr(">room</text>"),
                                      HasSubstr("class=\"offline-points\""), HasSubstr("class=\"keyframes\"")));
  EXPECT_EQ(run("draw room.byre -o room.PNG --width 500").exit_code, 0);
  EXPECT_THAT(read("room.PNG"), StartsWith(kPngBegin));
}

TEST_F(DrawProgram, IsDeterministic) {
  ASSERT_EQ(run("draw room.byre -o a.svg").exit_code, 0);
  ASSERT_EQ(run("draw room.byre -o b.svg").exit_code, 0);
  EXPECT_EQ(read("a.svg"), read("b.svg"));
}

TEST_F(DrawProgram, DrawsTrajectoriesOfFiles) {
  ASSERT_EQ(
      run("run " + rendered_room() + " --map room.byre --trajectory round.txt --stats stats.json --quiet").exit_code,
      0);
  const Outcome outcome = run("draw room.byre --trajectory round.txt --mission stats.json -o ways.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(read("ways.svg"),
              AllOf(HasSubstr(">round</text>"), HasSubstr(">trusted</text>"), HasSubstr(">start</text>")));
}

TEST_F(DrawProgram, DrawsAMissionAndItsCameraImage) {
  const Outcome outcome = draw_mission("--at 0.5 --camera-picture shot.svg -o where.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("mission      12 poses\n"), HasSubstr("camera at    0.45 s\n")));
  EXPECT_THAT(read("shot.svg"), AllOf(HasSubstr("class=\"offline-inliers\""), HasSubstr(">0.45 s</text>"),
                                      HasSubstr(">tracking</text>"), HasSubstr("data:image/")));
  EXPECT_THAT(read("where.svg"), AllOf(HasSubstr(">trusted</text>"), HasSubstr(">camera</text>")));
}

TEST_F(DrawProgram, ShowsTheLastFrameByDefault) {
  EXPECT_THAT(draw_mission("--camera-picture shot.png").output, HasSubstr("camera at    1.15 s\n"));
  EXPECT_THAT(read("shot.png"), StartsWith(kPngBegin));
}

TEST_F(DrawProgram, StopsAtTheTimeOfThePicture) {
  EXPECT_THAT(draw_mission("--at 0.3 --camera-picture shot.png").output, HasSubstr("mission      3 poses\n"));
}

TEST_F(DrawProgram, WritesAVideoOfAMission) {
  const Outcome outcome = draw_mission("--video round.mp4 --speed 2");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("video        12 frames, "));
  EXPECT_THAT(read("round.mp4").substr(4, 4), "ftyp");
}

TEST_F(DrawProgram, LimitsTheFrameRateOfTheVideo) {
  EXPECT_THAT(draw_mission("--video round.mp4 --speed 9").output, HasSubstr("video        4 frames, "));
}

TEST_F(DrawProgram, RejectsWrongUsage) {
  for (const char* const arguments :
       {"draw", "draw room.byre", "draw room.byre -o room.jpg", "draw room.byre --camera-picture shot.png",
        "draw room.byre --video a.mp4", "draw room.byre -o a.svg --heights 2:1", "draw room.byre -o a.svg --heights 1",
        "draw room.byre -o a.svg --width 3", "draw RECORDING --map room.byre --video a.avi",
        "draw RECORDING --map room.byre -o a.svg --camera-picture ./a.svg",
        "draw RECORDING --map room.byre --at -1 -o a.svg", "draw room.byre --grid a.png",
        "draw room.byre -o a.svg --grid-resolution 0.1", "draw room.byre --grid a.pgm --grid-resolution 0",
        "draw room.byre --grid a.pgm --grid-heights 2:1", "draw room.byre --grid a.pgm --grid-heights 1",
        "draw room.byre --grid a.pgm --footprint -1"}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 2) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith("byre: error: ")) << arguments;
    EXPECT_THAT(outcome.output, IsEmpty()) << arguments;
  }
}

TEST_F(DrawProgram, NamesBadInput) {
  write("torn.byre", "BYRE");
  write("no.json", "{}");
  write("plan.json", R"({"protocol":{"pose_frame":"plan"},"frames":[]})");
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"absent.byre -o a.svg", "byre: error: absent.byre: "},
      {"torn.byre -o a.svg", "byre: error: torn.byre: "},
      {"room.byre -o nowhere/a.svg", "byre: error: nowhere/a.svg: cannot be written"},
      {"room.byre --plan plan.yaml -o a.svg", "byre: error: room.byre: is not registered on a floor plan"},
      {"room.byre --trajectory absent.txt -o a.svg", "byre: error: absent.txt: "},
      {"room.byre --mission absent.json -o a.svg", "byre: error: absent.json: cannot be opened"},
      {"room.byre --mission no.json -o a.svg", "byre: error: no.json: is not a statistics file of a mission"},
      {"room.byre --mission plan.json -o a.svg", "byre: error: plan.json: has poses on the floor plan"},
      {"absent --map room.byre -o a.svg", "byre: error: absent: is not a folder"},
      {rendered_room() + " --map room.byre --start 0.5 --at 0.2 -o a.svg", "byre: error: "},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("draw " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
    EXPECT_FALSE(fs::exists(folder_ / "a.svg")) << arguments;
  }
}

// Map registered on a plan.
class DrawOnPlanProgram : public ProgramTest {
 protected:
  DrawOnPlanProgram() {
    StoredMap stored = driven_barn(scene_);
    stored.plan = PlanRegistration{"plan.yaml", scene_.plan_from_map, Matrix7::Identity()};
    save_map(stored, folder_ / "barn.byre");
    write("plan.pgm", plan_image(420, 140));
    write("plan.yaml", "image: plan.pgm\nresolution: 0.1\norigin: [-1, -7, 0]\n");
  }

  FloorPlanScene scene_;
};

TEST_F(DrawOnPlanProgram, DrawsThePlanBelowTheMap) {
  const Outcome outcome = run("draw barn.byre --plan plan.yaml -o barn.svg --width 840");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(read("barn.svg"),
              AllOf(HasSubstr("<image width=\"420\" height=\"140\""),
                    HasSubstr("<svg x=\"0\" y=\"38\" width=\"840\" height=\"280\">"), HasSubstr("above the floor")));
}

TEST_F(DrawOnPlanProgram, UsesThePlanFrameWithoutThePlan) {
  ASSERT_EQ(run("draw barn.byre -o barn.svg").exit_code, 0);
  EXPECT_THAT(read("barn.svg"), AllOf(Not(HasSubstr("<image")), HasSubstr("class=\"keyframes\"")));
}

TEST_F(DrawOnPlanProgram, WritesAnOccupancyGrid) {
  const Outcome outcome = run("draw barn.byre --grid grid.pgm --grid-resolution 0.1 --footprint 0.5");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("cells of 0.1 m: "), HasSubstr("written      grid.pgm\nwritten      grid.yaml\n")));
  const DrawnFloorPlan read = read_drawn_floor_plan(folder_ / "grid.yaml");
  const StoredMap stored = load_map(folder_ / "barn.byre");
  const auto grid = occupancy_grid(stored.map, stored.plan, {.resolution = 0.1, .footprint_radius = 0.5});
  ASSERT_TRUE(grid);
  EXPECT_EQ(read.occupancy, grid->occupancy);
  EXPECT_EQ(read.plan.width, grid->plan.width);
  EXPECT_LT((read.plan.top_left_in_plan - grid->plan.top_left_in_plan).norm(), 1e-9);
}

TEST_F(DrawOnPlanProgram, DrawsNextToTheGrid) {
  const Outcome outcome = run("draw barn.byre --grid grid.pgm --grid-heights 0.2:1.5 -o barn.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(read("barn.svg"), HasSubstr("class=\"keyframes\""));
  EXPECT_THAT(read("grid.pgm"), StartsWith("P5\n"));
}

TEST_F(DrawOnPlanProgram, WritesNoGridOverAnInputOrAnotherFile) {
  EXPECT_EQ(run("draw barn.byre --plan plan.yaml --grid plan.pgm").exit_code, 2);
  write("grid.yaml", "BYRE");
  EXPECT_EQ(run("draw barn.byre --grid grid.pgm").exit_code, 2);
  EXPECT_EQ(read("grid.yaml"), "BYRE");
}

TEST_F(DrawOnPlanProgram, RefusesAGridOfTooManyCells) {
  const Outcome outcome = run("draw barn.byre --grid grid.pgm --grid-resolution 0.001");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("occupancy grid: has "));
  EXPECT_FALSE(fs::exists(folder_ / "grid.pgm"));
}

TEST_F(DrawOnPlanProgram, RefusesAGridWithoutMetres) {
  StoredMap stored = driven_barn(scene_);
  stored.scale = MapScale::unknown;
  save_map(stored, folder_ / "mono.byre");
  const Outcome outcome = run("draw mono.byre --grid grid.pgm");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("mono.byre: has no metric scale, which occupancy grids need"));
}

TEST_F(DrawOnPlanProgram, ReportsAMissingPlanImage) {
  fs::remove(folder_ / "plan.pgm");
  EXPECT_EQ(run("draw barn.byre --plan plan.yaml -o barn.svg").exit_code, 3);
}

}  // namespace
}  // namespace byre::cli
