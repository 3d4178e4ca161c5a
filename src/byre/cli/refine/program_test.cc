// "byre refine" and "byre map --extend".

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/map/stored_map_scene.h"
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
using testing::StartsWith;

// Unfinished map of the room's first half.
class RefineProgram : public ProgramTest {
 protected:
  RefineProgram() { map_room("--frames :14 --no-loops", "room.byre"); }

  void write_map_of_unknown_scale() const {
    StoredMap stored = StoredMapScene(4, 9).stored();
    stored.scale = MapScale::unknown;
    save_map(stored, folder_ / "unknown.byre");
  }
};

TEST_F(RefineProgram, ReplacesTheMapAndReportsChanges) {
  const std::string before = read("room.byre");
  const Outcome outcome = run("refine room.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, StartsWith("map          room.byre: "));
  EXPECT_THAT(outcome.output, HasSubstr("parts        1 -> 1 without common points\n"));
  EXPECT_THAT(outcome.output, HasSubstr("written      room.byre\n"));
  EXPECT_THAT(outcome.errors, HasSubstr("finishing: adjusting the whole map\n"));
  EXPECT_NE(read("room.byre"), before);
  EXPECT_EQ(run("validate room.byre").exit_code, 0);
}

TEST_F(RefineProgram, LeavesTheInputUnchangedWithAnOutput) {
  const std::string before = read("room.byre");
  const Outcome outcome = run("refine room.byre -o better.byre --json --quiet");
  EXPECT_THAT(outcome.errors, IsEmpty());
  EXPECT_EQ(read("room.byre"), before);
  const json finishing = json::parse(outcome.output).at("finishing");
  EXPECT_EQ(finishing.at("after").at("keyframes"), load_map(folder_ / "better.byre").map.keyframe_count());
  EXPECT_EQ(finishing.at("before").at("keyframes"), load_map(folder_ / "room.byre").map.keyframe_count());
  EXPECT_LT(finishing.at("after").at("reprojection_p95_px"), 1.0);
}

TEST_F(RefineProgram, NamesBadInput) {
  write_map_of_unknown_scale();
  EXPECT_THAT(run("refine absent.byre").errors, StartsWith("byre: error: absent.byre: "));
  const Outcome outcome = run("refine unknown.byre");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, StartsWith("byre: error: unknown.byre: has no metric scale"));
  EXPECT_EQ(run("refine").exit_code, 2);
}

TEST_F(RefineProgram, ExtendsAMapAndStoresItsRecordings) {
  const std::string before = read("room.byre");
  const Outcome outcome = run("map " + rendered_room() +
                              " --frames 8: --extend room.byre -o both.byre --trajectory second.txt --site Room");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("extended     room.byre, localised in it after 0 frames\n"));
  EXPECT_EQ(read("room.byre"), before);
  const StoredMap both = load_map(folder_ / "both.byre");
  EXPECT_THAT(both.recordings, SizeIs(2));
  EXPECT_EQ(both.notes.at("site"), "Room");
  EXPECT_THAT(find_faults(both), IsEmpty());
  const json recordings = json::parse(run("inspect both.byre --json").output).at("recordings");
  EXPECT_GT(recordings.at(0).at("keyframes"), 0);
  EXPECT_GT(recordings.at(1).at("keyframes"), 0);
}

TEST_F(RefineProgram, RejectsExtensionOfAMapOfAnotherPlace) {
  const fs::path elsewhere = folder_ / "elsewhere";
  RenderedRoomOptions other;
  other.seed = 99;
  const Calibration calibration = euroc_like_calibration(4);
  write_euroc_recording(RenderedRoom(other), calibration,
                        figure_eight_trajectory(4, 20.0, 3.0, 0.05, calibration.body_from_left), elsewhere, {});
  const Outcome outcome = run("map elsewhere --extend room.byre -o both.byre");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, HasSubstr("extended     room.byre, never localised in it\n"));
  EXPECT_THAT(outcome.errors, HasSubstr("byre: error: no frame was localised in room.byre: "));
  EXPECT_FALSE(fs::exists(folder_ / "both.byre"));
}

TEST_F(RefineProgram, RejectsExtensionOfAMapOfUnknownScale) {
  write_map_of_unknown_scale();
  const Outcome outcome = run("map " + rendered_room() + " --extend unknown.byre -o both.byre");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, StartsWith("byre: error: unknown.byre: has no metric scale"));
}

}  // namespace
}  // namespace byre::cli
