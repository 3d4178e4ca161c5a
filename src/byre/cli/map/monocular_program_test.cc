// Mapping with one camera, and missions with one camera on a stereo map.

#include "byre/cli/shared/program_fixture.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <string>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

class MonocularProgram : public ProgramTest {
 protected:
  Outcome map_by_left_camera() const {
    return run_once("map " + rendered_bend() +
                    " --camera left -o mono.byre --trajectory mono.txt --stats s.json --quiet");
  }
};

TEST_F(MonocularProgram, MapsWithOneCameraAndReportsInitialisationAndScale) {
  const Outcome outcome = map_by_left_camera();
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("of the left camera"), HasSubstr("s after the first frame, at frame"),
                                    HasSubstr("arbitrary; set it with \"byre scale\"")));
  EXPECT_EQ(json::parse(read("s.json"))["protocol"]["scale"], "unknown");
  const StoredMap stored = load_map(folder_ / "mono.byre");
  EXPECT_EQ(stored.scale, MapScale::unknown);
  EXPECT_FALSE(stored.map.rigs().front().is_stereo());
  const Outcome judged = run("evaluate --estimate mono.txt --truth " + rendered_bend() + " --frames-of " +
                             rendered_bend() + " --camera left --estimate-of camera --alignment sim3 --json");
  ASSERT_EQ(judged.exit_code, 0) << judged.errors;
  EXPECT_LT(json::parse(judged.output)["ate"]["translation_m"]["rmse"], 0.02);
}

TEST_F(MonocularProgram, RunsAMissionOnceTheMapIsScaled) {
  ASSERT_EQ(map_by_left_camera().exit_code, 0);
  const Outcome refused = run("run " + rendered_bend() + " --camera left --map mono.byre --quiet");
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.errors, AllOf(HasSubstr("has no metric scale"), HasSubstr("byre scale")));
  const Outcome scaled = run("scale mono.byre --between 0,0,0 0,0,1 --metres 3 -o metric.byre");
  ASSERT_EQ(scaled.exit_code, 0) << scaled.errors;
  EXPECT_THAT(scaled.output, HasSubstr("a unit is 3 m"));
  EXPECT_EQ(run("run " + rendered_bend() + " --camera left --map metric.byre --quiet").exit_code, 0);
}

TEST_F(MonocularProgram, RunsOnAStereoMapWithItsScale) {
  ASSERT_EQ(run_once("map " + rendered_bend() + " -o stereo.byre --quiet").exit_code, 0);
  for (const std::string camera : {"left", "right"}) {
    const Outcome outcome = run("run " + rendered_bend() + " --camera " + camera + " --map stereo.byre --truth " +
                                rendered_bend() + " --stats s.json --quiet");
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const json mission = json::parse(read("s.json"));
    EXPECT_EQ(mission["counts"]["coverage"], 1.0) << camera;
    EXPECT_LT(mission["errors"]["final"]["position_m"]["rmse"], 0.02) << camera;
  }
}

}  // namespace
}  // namespace byre::cli
