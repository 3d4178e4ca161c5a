// "byre run --save-session", "byre update", "byre history" and "byre diff".

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_upkeep.h"
#include "byre/simulation/rendered_scene.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A map of half of the recording, and a mission on all of it.
class UpdateProgram : public ProgramTest {
 protected:
  UpdateProgram() {
    map_room("--frames :12", "room.byre");
    const Outcome mission =
        run_once("run " + rendered_room() + " --map room.byre --save-session evening.session --quiet");
    EXPECT_EQ(mission.exit_code, 0) << mission.errors;
  }
};

TEST_F(UpdateProgram, SavesASessionThatIsAMapToo) {
  const std::string bytes = read("evening.session");
  const MapUpkeep upkeep = read_upkeep(std::as_bytes(std::span(bytes)), "evening.session");
  ASSERT_TRUE(upkeep.session);
  EXPECT_EQ(upkeep.session->map_id, map_id(folder_ / "room.byre"));
  EXPECT_EQ(upkeep.session->frames, 24u);
  EXPECT_GT(upkeep.session->trusted, 12u);
  EXPECT_FALSE(upkeep.session->poses.empty());
  EXPECT_GT(std::ranges::count_if(upkeep.session->points, [](const PointRecord& point) { return point.seen > 0; }), 50);
  EXPECT_EQ(run("validate evening.session").exit_code, 0);
}

TEST_F(UpdateProgram, WritesAChildThatIsNowhereWorse) {
  const std::string before = read("room.byre");
  const Outcome outcome = run("update room.byre evening.session -o room_2.byre --picture added.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.output << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("session      evening: "), HasSubstr("written      room_2.byre\n"),
                                    HasSubstr("Changes: byre view room_2.byre --before room.byre. "
                                              "Next: byre run RECORDING --map room_2.byre\n")));
  EXPECT_EQ(read("room.byre"), before);
  EXPECT_EQ(run("validate room_2.byre").exit_code, 0);
  EXPECT_THAT(run("history room_2.byre").output,
              HasSubstr("\n" + to_text(map_id(folder_ / "room.byre")) + " evening: "));
  const json diff = json::parse(run("diff room.byre room_2.byre --json").output);
  EXPECT_EQ(diff.at("keyframes").at("removed"), 0);
  EXPECT_EQ(diff.at("points").at("removed"), 0);
  EXPECT_EQ(diff.at("points").at("same"), load_map(folder_ / "room.byre").map.point_count());
  EXPECT_EQ(run("diff room.byre room_2.byre --picture changes.svg").exit_code, 0);
  EXPECT_THAT(read("added.svg"), HasSubstr("keyframes"));
  EXPECT_THAT(read("changes.svg"), AllOf(HasSubstr("room -&gt; room_2"), HasSubstr("keyframes")));
}

TEST_F(UpdateProgram, PrintsTheReportAsJson) {
  const Outcome outcome = run("update room.byre evening.session -o room_2.byre --json --quiet");
  EXPECT_THAT(outcome.errors, IsEmpty());
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("written"), "room_2.byre");
  EXPECT_TRUE(report.at("refusal").is_null());
  const json& session = report.at("sessions").at(0);
  EXPECT_GT(session.at("keyframes_found_after"), 0);
  EXPECT_EQ(session.at("keyframes_found_after"), report.at("proof").at("found_after")) << "of one session";
  EXPECT_EQ(session.at("places"), report.at("proof").at("places"));
  EXPECT_GT(session.at("brightness"), 10.0);
  EXPECT_GE(report.at("proof").at("found_after"), report.at("proof").at("found_before"));
}

TEST_F(UpdateProgram, RefusesASessionOnAnotherMap) {
  map_room("--stride 2", "other.byre");
  const Outcome outcome = run("update other.byre evening.session -o other_2.byre");
  EXPECT_EQ(outcome.exit_code, 1);
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("not used, it ran on another map"),
                                    HasSubstr("other.byre stays as it is: no session fits the map.")));
  EXPECT_FALSE(fs::exists(folder_ / "other_2.byre"));
}

TEST_F(UpdateProgram, NamesBadInput) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"room.byre room.byre", "byre: error: room.byre: is a map, not a session"},
      {"evening.session evening.session", "byre: error: evening.session: is a session, not a map"},
      {"absent.byre evening.session", "byre: error: absent.byre: "},
  };
  for (const auto& [arguments, message] : cases) {
    const Outcome outcome = run("update " + arguments + " -o new.byre");
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
  }
  EXPECT_EQ(run("update room.byre -o new.byre").exit_code, 2);
  EXPECT_EQ(run("update room.byre evening.session -o room.byre").exit_code, 2) << "the old map stays";
}

}  // namespace
}  // namespace byre::cli
