
#include "byre/cli/shared/program_fixture.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/playback/archive/register_scene.h"

#include <cmath>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

class RegisterProgram : public ProgramTest {
 protected:
  RegisterProgram() {
    save_map(driven_barn(scene_), folder_ / "barn.byre");
    write("plan.pgm", plan_image(420, 140));
    write("plan.yaml", "image: plan.pgm\nresolution: 0.1\norigin: [-1, -7, 0]\n");
    write("picks.csv", picks_csv(scene_.correspondences(6)));
  }

  FloorPlanScene scene_;
};

TEST_F(RegisterProgram, WritesARegisteredMap) {
  const std::string before = read("barn.byre");
  const Outcome outcome = run("register barn.byre --plan plan.yaml --points picks.csv -o barn-plan.byre");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("plan         plan.yaml, 420 x 140 pixels of 100.0 mm\n"),
                    HasSubstr("points       6; 6 inliers, RMSE 0.000 m"),
                    HasSubstr("fits         sign 5: error 0.000 m"), HasSubstr("written      barn-plan.byre\n")));
  EXPECT_THAT(outcome.errors, IsEmpty());
  const StoredMap stored = load_map(folder_ / "barn-plan.byre");
  ASSERT_TRUE(stored.plan.has_value());
  EXPECT_EQ(stored.plan->plan, "plan.yaml");
  EXPECT_THAT(stored.plan->plan_from_map.target_from_source,
              PoseNear(scene_.plan_from_map.target_from_source, 1e-5, 1e-6));
  EXPECT_EQ(read("barn.byre"), before);
  EXPECT_THAT(run("inspect barn-plan.byre").output,
              HasSubstr("plan           plan.yaml: the map's origin is at x 7.000"));
}

TEST_F(RegisterProgram, ReportsAWrongPick) {
  auto correspondences = scene_.correspondences(8);
  correspondences[3].name = "water trough";
  correspondences[3].point_in_plan.x() += 2.0;
  write("picks.csv", picks_csv(correspondences));
  const Outcome outcome = run("register barn.byre --plan plan.yaml --points picks.csv --json");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const json report = json::parse(outcome.output);
  for (const json& point : report.at("points")) EXPECT_EQ(point.at("outlier"), point.at("name") == "water trough");
  EXPECT_THAT(report.at("doubts"), IsEmpty());
  EXPECT_TRUE(report.at("written").is_null());
  EXPECT_THAT(run("register barn.byre --plan plan.yaml --points picks.csv").output,
              HasSubstr("outlier      water trough: error 2.000 m (x -2.000, y "));
}

TEST_F(RegisterProgram, WritesNoMapWithLargeResidualsUnlessAccepted) {
  auto correspondences = scene_.correspondences(6);
  for (PlanCorrespondence& each : correspondences) each.point_in_plan *= 1.5;  // wrong resolution of the plan
  write("picks.csv", picks_csv(correspondences));
  const std::string command = "register barn.byre --plan plan.yaml --points picks.csv -o barn-plan.byre";
  const Outcome refused = run(command);
  EXPECT_EQ(refused.exit_code, 3);
  EXPECT_THAT(refused.output, AllOf(HasSubstr("points       6; "), Not(HasSubstr("written"))));
  EXPECT_THAT(refused.errors,
              ContainsRegex("picks.csv: has residuals of [0-9]+\\.[0-9]+ m on the map, so the map is not "
                            "written.*--accept-residual [0-9]+\\.[0-9]+ writes the map"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "barn-plan.byre"));
  EXPECT_EQ(run(command + " --accept-residual 0.6").exit_code, 3) << "less than the residual";
  EXPECT_EQ(run(command + " --accept-residual 100").exit_code, 0);
  EXPECT_TRUE(load_map(folder_ / "barn-plan.byre").plan.has_value());
}

TEST_F(RegisterProgram, RegistersAMapInAProjectedCoordinateSystem) {
  write("plan.wld", "0.1\n0\n0\n-0.1\n499999.05\n5400006.95\n");
  auto correspondences = scene_.correspondences(6);
  for (PlanCorrespondence& each : correspondences) each.point_in_plan += Eigen::Vector2d(500000.0, 5400000.0);
  write("picks.csv", picks_csv(correspondences));
  EXPECT_EQ(run("register barn.byre --plan plan.pgm --points picks.csv -o barn.byre").exit_code, 0);
  Pose expected = scene_.plan_from_map.target_from_source;
  expected.translation += Eigen::Vector3d(500000.0, 5400000.0, 0.0);
  EXPECT_THAT(load_map(folder_ / "barn.byre").plan.value().plan_from_map.target_from_source,
              PoseNear(expected, 1e-5, 1e-6));
}

TEST_F(RegisterProgram, CorrectsTheScaleOfAStereoMapOnce) {
  const FloorPlanScene scene(1, 1.0 / 1.016);
  FloorPlanScene driven = scene;
  const StoredMap before = driven_barn(driven);
  save_map(before, folder_ / "large.byre");
  write("picks.csv", keyframe_picks_csv(scene, before));
  const std::string arguments = " --plan plan.yaml --points picks.csv";
  EXPECT_THAT(run("register large.byre" + arguments).output,
              ContainsRegex("scale        the map is 1\\.6. % \\+- 0\\.0. % too large: correct it with --fix-scale\n"));

  const Outcome once = run("register large.byre" + arguments + " --fix-scale -o mended.byre");
  EXPECT_EQ(once.exit_code, 0) << once.errors;
  EXPECT_THAT(once.output,
              ContainsRegex("scale        the map was 1\\.6. % \\+- 0\\.0. % too large: lengths and baseline are "
                            "scaled by 0\\.98.*\n"));
  const StoredMap corrected = load_map(folder_ / "mended.byre");
  EXPECT_NEAR(corrected.map.rigs()[0].baseline * 1.016, before.map.rigs()[0].baseline, 1e-4);
  EXPECT_EQ(corrected.plan.value().plan_from_map.scale, 1.0);
  EXPECT_EQ(corrected.recordings[0].calibration.right->right_from_left.translation.x(), -0.11) << "as it was given";
  const Eigen::Vector3d far = body_at(corrected.map, *corrected.map.find_keyframe({Origin::offline, 39}));
  EXPECT_THAT(corrected.plan->plan_from_map * far, PointNear(Eigen::Vector3d(40.0, -1.0, 0.0), 0.03));

  const Outcome twice = run("register mended.byre" + arguments + " --fix-scale --json -o again.byre");
  const json report = json::parse(twice.output);
  EXPECT_EQ(report.at("scaled_by"), 1.0);
  EXPECT_LT(std::abs(report.at("measured_scale").at("too_large_percent").get<double>()), 0.1);
  EXPECT_FALSE(report.at("measured_scale").at("differs").get<bool>());
  EXPECT_EQ(load_map(folder_ / "again.byre").map.rigs()[0].baseline, corrected.map.rigs()[0].baseline);
  EXPECT_THAT(run("register mended.byre" + arguments + " --fix-scale -o again.byre").output,
              HasSubstr("scale        no correction needed: "));
  EXPECT_EQ(run("validate mended.byre").exit_code, 0);
}

TEST_F(RegisterProgram, RejectsImpossibleScaleCorrections) {
  write("three.csv", picks_csv(scene_.correspondences(3)));
  const Outcome few = run("register barn.byre --plan plan.yaml --points three.csv --fix-scale -o out.byre");
  EXPECT_EQ(few.exit_code, 3);
  EXPECT_THAT(few.errors, HasSubstr("three.csv: does not determine the scale: fewer than four"));
  StoredMap unscaled = driven_barn(scene_);
  unscaled.scale = MapScale::unknown;
  save_map(unscaled, folder_ / "mono.byre");
  const Outcome mono = run("register mono.byre --plan plan.yaml --points picks.csv --fix-scale -o out.byre");
  EXPECT_EQ(mono.exit_code, 3);
  EXPECT_THAT(mono.errors, HasSubstr("or set it with byre scale"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.byre"));
  EXPECT_EQ(run("register barn.byre --plan plan.yaml --points picks.csv --fix-scale").exit_code, 2) << "without -o";
}

TEST_F(RegisterProgram, RefusesToMatchAPlanWithoutWalls) {
  const Outcome outcome = run("register barn.byre --plan plan.yaml --auto -o out.byre");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("barn.byre: has no obstacles to match, or the plan has no walls"));
  EXPECT_EQ(run("register barn.byre --plan plan.yaml --auto --points picks.csv").exit_code, 2);
}

using LongRunRegisterProgram = ProgramTest;

// Through the gate, as the hall alone is symmetric.
TEST_F(LongRunRegisterProgram, MatchesABarnWithItsPlan) {
  ASSERT_EQ(run("simulate cowshed --divide 2 --rate 8 --gate open --duration 60 -o day --quiet").exit_code, 0);
  ASSERT_EQ(run("map day -o barn.byre --quiet").exit_code, 0);
  const Outcome matched = run("register barn.byre --plan day/plan/plan.yaml --auto -o auto.byre");
  ASSERT_EQ(matched.exit_code, 0) << matched.errors;
  ASSERT_EQ(run("register barn.byre --plan day/plan/plan.yaml --points day/plan/picks.csv -o picked.byre").exit_code,
            0);
  EXPECT_THAT(load_map(folder_ / "auto.byre").plan->plan_from_map.target_from_source,
              PoseNear(load_map(folder_ / "picked.byre").plan->plan_from_map.target_from_source, 0.15, 0.01));
}

TEST_F(RegisterProgram, ReportsDoubtsForTooFewPicks) {
  write("picks.csv", picks_csv(scene_.correspondences(2)));
  const Outcome outcome = run("register barn.byre --plan plan.yaml --points picks.csv");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("doubt        fewer than three correspondences are used"));
}

TEST_F(RegisterProgram, RejectsBadInput) {
  write("one.csv", picks_csv(scene_.correspondences(1)));
  const Outcome outcome = run("register barn.byre --plan plan.yaml --points one.csv -o out.byre");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("one.csv: needs two distant points"));
  EXPECT_FALSE(std::filesystem::exists(folder_ / "out.byre"));
  EXPECT_EQ(run("register absent.byre --plan plan.yaml --points picks.csv").exit_code, 3);
  EXPECT_EQ(run("register barn.byre --plan absent.yaml --points picks.csv").exit_code, 3);
  EXPECT_EQ(run("register barn.byre --points picks.csv").exit_code, 2);
  EXPECT_EQ(run("register barn.byre --plan plan.yaml --points picks.csv --pick-sigma 0").exit_code, 2);
}

TEST_F(RegisterProgram, RejectsPosesOnAPlanForAnUnregisteredMap) {
  write("photo.pgm", plan_image(320, 240));
  const Outcome outcome = run("localise barn.byre photo.pgm --frame plan");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors,
              HasSubstr("barn.byre: is not registered on a floor plan, so poses on a plan are not available"));
  EXPECT_EQ(run("localise barn.byre photo.pgm --frame world").exit_code, 2);
  EXPECT_EQ(run("run recording --frame plan").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
