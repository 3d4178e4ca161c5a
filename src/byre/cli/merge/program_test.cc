// "byre merge" and "byre cut".

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Maps of the beginning and of the end of a visit to a room, which overlap.
class MergeProgram : public ProgramTest {
 protected:
  MergeProgram() {
    map_bend("--frames :30", "begin.byre");
    map_bend("--frames 10:", "end.byre");
  }

  void map_bend(const std::string& options, const std::string& file) const {
    const Outcome outcome = run_once("map " + rendered_bend() + " " + options + " --quiet -o " + file);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  }
};

TEST_F(MergeProgram, MergesMapsThatOverlap) {
  const std::string begin = read("begin.byre");
  const Outcome outcome = run("merge begin.byre end.byre -o both.byre --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors << outcome.output;
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("keyframes_agreeing"), report.at("keyframes_found"));
  EXPECT_EQ(report.at("finishing").at("after").at("parts"), 1);
  EXPECT_EQ(read("begin.byre"), begin);
  const StoredMap both = load_map(folder_ / "both.byre");
  EXPECT_THAT(both.recordings, SizeIs(2));
  EXPECT_THAT(find_faults(both), IsEmpty());
  EXPECT_GT(both.map.keyframe_count(), load_map(folder_ / "end.byre").map.keyframe_count());
}

TEST_F(MergeProgram, GivesTheScaleOfTheFirstMapToAMapOfOneCamera) {
  map_bend("--camera left", "left.byre");
  const Outcome outcome = run("merge begin.byre left.byre -o both.byre --json");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors << outcome.output;
  EXPECT_NE(json::parse(outcome.output).at("scale"), 1.0);
  EXPECT_EQ(load_map(folder_ / "both.byre").scale, MapScale::metric);
}

TEST_F(MergeProgram, RejectsAMapOfAnotherPlace) {
  RenderedRoomOptions other;
  other.seed = 99;
  const Calibration calibration = euroc_like_calibration(4);
  write_euroc_recording(RenderedRoom(other), calibration,
                        figure_eight_trajectory(4, 20.0, 3.0, 0.05, calibration.body_from_left), folder_ / "elsewhere",
                        {});
  ASSERT_EQ(run("map elsewhere -o elsewhere.byre").exit_code, 0);
  const Outcome outcome = run("merge begin.byre elsewhere.byre -o both.byre");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("Not merged: the second map was not placed in the first"));
  EXPECT_FALSE(fs::exists(folder_ / "both.byre"));
}

TEST_F(MergeProgram, CutsARegionAndKeepsTheRest) {
  const int points = load_map(folder_ / "begin.byre").map.point_count();
  const std::string box = "--box -100 -100 -100 100 0 100";
  EXPECT_EQ(run("cut begin.byre " + box + " -o left.byre").exit_code, 0);
  EXPECT_EQ(run("cut begin.byre " + box + " --keep -o right.byre").exit_code, 0);
  const StoredMap left = load_map(folder_ / "left.byre"), right = load_map(folder_ / "right.byre");
  EXPECT_THAT(find_faults(left), IsEmpty());
  EXPECT_GT(left.map.point_count(), 0);
  EXPECT_EQ(left.map.point_count() + right.map.point_count(), points);
}

TEST_F(MergeProgram, NamesARegionThatCannotBeCut) {
  const Outcome empty = run("cut begin.byre --box 90 90 90 91 91 91 -o less.byre");
  EXPECT_EQ(empty.exit_code, 3);
  EXPECT_THAT(empty.errors, HasSubstr("begin.byre: would lose no point"));
  const Outcome no_plan = run("cut begin.byre --polygon 0 0 1 0 1 1 -o less.byre");
  EXPECT_EQ(no_plan.exit_code, 3);
  EXPECT_THAT(no_plan.errors, HasSubstr("is not registered on a floor plan"));
  EXPECT_EQ(run("cut begin.byre -o less.byre").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
