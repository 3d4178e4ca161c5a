
#include "byre/cli/shared/program_fixture.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_scene.h"
#include "byre/trajectory_file.h"

#include <cmath>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

// Every other frame of the room is mapped; the rest is localised.
class LocaliseProgram : public ProgramTest {
 protected:
  LocaliseProgram() { map_room("--stride 2", "room.byre"); }

  Outcome localise(const std::string& arguments) const { return run("localise room.byre " + arguments); }
};

TEST_F(LocaliseProgram, LocalisesTheOtherFrames) {
  const Outcome outcome =
      localise(rendered_room() + " --frames 1: --stride 2 --trajectory found.txt --truth " + rendered_room());
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("found        12 of 12 frames (100.0 %)"));
  EXPECT_THAT(outcome.output, HasSubstr("within 0.1 m and 2 deg"));
  EXPECT_THAT(read_trajectory(folder_ / "found.txt"), SizeIs(12));
}

TEST_F(LocaliseProgram, ReportsTheResultOfEachFrame) {
  const Outcome outcome =
      localise(rendered_room() + " --frames 1:4 --stride 2 --json --quiet --truth " + rendered_room());
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("frames_found"), 2);
  ASSERT_EQ(report.at("per_frame").size(), 2);
  EXPECT_EQ(report.at("per_frame").at(0).at("found"), true);
  EXPECT_EQ(report.at("per_frame").at(0).at("position_in_map_m").size(), 3);
  EXPECT_LT(report.at("errors").at("position_m").at("max"), 0.05);
  EXPECT_THAT(outcome.errors, IsEmpty());
}

TEST_F(LocaliseProgram, LocalisesTheBodyByEitherCamera) {
  for (const char* const camera : {"left", "right"}) {
    const Outcome outcome =
        localise(rendered_room() + " --frames 1: --stride 4 --json --camera " + camera + " --truth " + rendered_room());
    ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
    const json report = json::parse(outcome.output);
    EXPECT_EQ(report.at("frames_found"), 6) << camera;
    EXPECT_LT(report.at("errors").at("position_m").at("max"), 0.05) << camera;
  }
}

TEST_F(LocaliseProgram, LocalisesImagesOfAFolderWithTimesOfTheirNames) {
  const std::filesystem::path camera = RenderedFixture::shared().folder() / "mav0/cam1";
  const std::string images = quoted(camera / "data"), calibration = " --calibration " + quoted(camera / "sensor.yaml");
  const Outcome outcome = localise(images + calibration + " --stride 6 --json --truth " + rendered_room());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const json report = json::parse(outcome.output);
  EXPECT_EQ(report.at("frames_found"), 4);
  EXPECT_LT(report.at("errors").at("position_m").at("max"), 0.05);
  EXPECT_THAT(localise(images).errors, HasSubstr("contains no camera calibration"));
  EXPECT_THAT(localise(images + calibration + " --fps 20 --camera stereo").errors,
              HasSubstr("has images of one camera only"));
}

TEST_F(LocaliseProgram, WarnsOfAnAssumedFrameRate) {
  const std::filesystem::path folder = folder_ / "frames";
  std::filesystem::create_directory(folder);
  for (const std::size_t i : {0, 1}) {
    std::filesystem::copy(RenderedFixture::shared().image("cam0", i), folder / fmt::format("frame{}.png", i));
  }
  const std::string sensor = quoted(RenderedFixture::shared().folder() / "mav0/cam0/sensor.yaml");
  EXPECT_THAT(localise("frames --calibration " + sensor).errors, HasSubstr("30 frames per second are assumed"));
  const Outcome quiet = localise("frames --fps 20 --quiet --calibration " + sensor);
  EXPECT_THAT(quiet.errors, IsEmpty());
  EXPECT_THAT(quiet.output, HasSubstr("found        2 of 2 frames"));
}

TEST_F(LocaliseProgram, UsesTheGivenCameraForImages) {
  const std::string image = quoted(RenderedFixture::shared().image("cam1", 4));
  const auto position_by = [&](const std::string& options) {
    const json report = json::parse(localise(image + " --json" + options).output);
    return report.at("per_frame").at(0).at("position_in_map_m").get<std::vector<double>>();
  };
  const std::vector<double> of_right = position_by(" --camera right");
  const std::vector<double> of_calibration =
      position_by(" --calibration " + quoted(RenderedFixture::shared().folder() / "mav0/cam1/sensor.yaml"));
  const std::vector<double> of_left = position_by("");
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(of_right[axis], of_calibration[axis], 1e-6);
  const double apart = std::hypot(of_left[0] - of_right[0], of_left[1] - of_right[1], of_left[2] - of_right[2]);
  EXPECT_NEAR(apart, 0.11, 0.03) << "taken for the left camera's, the body is off by the baseline";
}

TEST_F(LocaliseProgram, GivesPosesOnThePlan) {
  StoredMap stored = load_map(folder_ / "room.byre");
  stored.plan.emplace();
  stored.plan->plan_from_map.target_from_source.translation << 1000.0, 2000.0, 0.0;
  save_map(stored, folder_ / "room.byre");
  const std::string frames = rendered_room() + " --frames 1:4 --stride 2 --quiet --json";
  localise(frames + " --trajectory map.txt");
  const json report = json::parse(localise(frames + " --trajectory plan.txt --frame plan").output);
  const Trajectory in_map = read_trajectory(folder_ / "map.txt");
  const Trajectory on_plan = read_trajectory(folder_ / "plan.txt");
  ASSERT_THAT(on_plan, SizeIs(2));
  const Eigen::Vector3d shift(1000.0, 2000.0, 0.0);
  EXPECT_THAT(on_plan[1].world_from_body.translation, PointNear(in_map[1].world_from_body.translation + shift, 1e-6));
  EXPECT_NEAR(report.at("per_frame").at(1).at("position_on_plan_m").at(0),
              report.at("per_frame").at(1).at("position_in_map_m").at(0).get<double>() + 1000.0, 1e-6);
}

TEST_F(LocaliseProgram, UsesTheCameraOfTheMapForImages) {
  const Outcome outcome = localise(quoted(RenderedFixture::shared().image("cam0", 1)) + " " +
                                   quoted(RenderedFixture::shared().image("cam0", 3)));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("found        2 of 2 frames"));
}

TEST_F(LocaliseProgram, ReadsTimesFromImageNames) {
  const RenderedFixture& room = RenderedFixture::shared();
  const auto named = [&](std::size_t frame, std::int64_t nanoseconds) {
    const std::string name = std::to_string(nanoseconds) + ".png";
    std::filesystem::copy_file(room.image("cam0", frame), folder_ / name);
    return name;
  };
  const std::string later = named(3, 1403715274402140000), earlier = named(1, 1403715274302140000);
  const Outcome outcome = localise(later + " " + earlier + " --trajectory found.txt");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  const Trajectory found = read_trajectory(folder_ / "found.txt");
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].time, Timestamp(1403715274302140000));
  EXPECT_EQ(found[1].time, Timestamp(1403715274402140000));
  ASSERT_EQ(localise(earlier + " --trajectory one.txt").exit_code, 0);
  EXPECT_EQ(read_trajectory(folder_ / "one.txt").at(0).time, Timestamp(1403715274302140000));
}

TEST_F(LocaliseProgram, RejectsAnotherRoomWithReason) {
  const std::filesystem::path elsewhere = folder_ / "elsewhere";
  RenderedRoomOptions other;
  other.seed = 99;
  const Calibration calibration = euroc_like_calibration(4);
  write_euroc_recording(RenderedRoom(other), calibration,
                        figure_eight_trajectory(4, 20.0, 3.0, 0.05, calibration.body_from_left), elsewhere, {});
  const Outcome outcome = localise(quoted(elsewhere));
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_THAT(outcome.output, HasSubstr("found        0 of 4 frames"));
  EXPECT_THAT(outcome.output, HasSubstr("not found    "));
}

TEST_F(LocaliseProgram, NamesBadInput) {
  write("torn.png", "torn");
  EXPECT_EQ(localise("torn.png").exit_code, 0) << "an image that cannot be read is a warning";
  EXPECT_THAT(localise("torn.png").errors, HasSubstr("torn.png: is not a complete image"));
  EXPECT_EQ(localise("absent").exit_code, 3);
  EXPECT_THAT(localise("absent").errors, HasSubstr("absent: does not exist"));
  EXPECT_EQ(localise(rendered_room() + " torn.png").exit_code, 3);
  EXPECT_THAT(localise(rendered_room() + " torn.png").errors, HasSubstr("one recording at a time"));
  write("torn.byre", read("room.byre").substr(0, 1000));
  const Outcome outcome = run("localise torn.byre " + rendered_room());
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("torn.byre"));
  EXPECT_EQ(run("localise room.byre").exit_code, 2);
  EXPECT_EQ(localise(rendered_room() + " --map-truth " + rendered_room()).exit_code, 2) << "without --truth";
}

}  // namespace
}  // namespace byre::cli
