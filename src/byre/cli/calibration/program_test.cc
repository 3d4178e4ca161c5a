// "byre calibration".

#include "byre/cli/shared/program_fixture.h"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::cli {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::HasSubstr;

std::string ros_camera(const std::string& fourth) {
  return "image_width: 752\nimage_height: 480\ndistortion_model: plumb_bob\n"
         "camera_matrix: {rows: 3, cols: 3, data: [458, 0, 367, 0, 457, 248, 0, 0, 1]}\n"
         "distortion_coefficients: {rows: 1, cols: 5, data: [-0.28, 0.07, 0.0002, 0.00002, 0]}\n"
         "rectification_matrix: {rows: 3, cols: 3, data: [1, 0, 0, 0, 1, 0, 0, 0, 1]}\n"
         "projection_matrix: {rows: 3, cols: 4, data: [400, 0, 370, " +
         fourth + ", 0, 400, 240, 0, 0, 0, 1, 0]}\n";
}

class CalibrationProgram : public ProgramTest {
 protected:
  CalibrationProgram() {
    write("left.yaml", ros_camera("0"));
    write("right.yaml", ros_camera("-44"));
    write("k.yaml", "K: [458, 0, 367, 0, 457, 248, 0, 0, 1]\nD: [0, 0, 0, 0]\n");
  }
};

TEST_F(CalibrationProgram, ShowsAPair) {
  const Outcome outcome = run("calibration show left.yaml right.yaml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output,
              AllOf(HasSubstr("format        ROS camera_info\n"),
                    HasSubstr("left          radial_tangential, 752x480, fx 458.000 fy 457.000 cx 367.000 cy 248.000"),
                    HasSubstr("distortion    -0.28 0.07 0.0002 2e-05\n"), HasSubstr("baseline      0.11000 m\n"),
                    HasSubstr("right in left 0.11000 0.00000 0.00000 m, turned by 0.000 deg\n"),
                    HasSubstr("rectified     752x480, focal length ")));
  EXPECT_EQ(run("calibration show .").output, outcome.output) << "the folder has both";
}

TEST_F(CalibrationProgram, ShowsJson) {
  const json shown = json::parse(run("calibration show right.yaml --json").output);
  EXPECT_EQ(shown.at("left").at("fx"), 458.0);
  EXPECT_FALSE(shown.contains("right"));
  EXPECT_THAT(shown.at("notes").at(0).get<std::string>(), HasSubstr("a camera of a stereo pair"));
}

TEST_F(CalibrationProgram, ConvertsToAFileThatIsShownAlike) {
  const Outcome converted = run("calibration convert left.yaml right.yaml -o calibration.yaml");
  EXPECT_EQ(converted.exit_code, 0) << converted.errors;
  const json before = json::parse(run("calibration show left.yaml right.yaml --json").output);
  const json after = json::parse(run("calibration show calibration.yaml --json").output);
  EXPECT_EQ(after.at("format"), "Kalibr camchain");
  EXPECT_EQ(after.at("left"), before.at("left"));
  EXPECT_EQ(after.at("right"), before.at("right"));
  EXPECT_EQ(after.at("baseline_m"), before.at("baseline_m"));
  EXPECT_EQ(run("calibration convert left.yaml -o left.yaml").exit_code, 2) << "the input";
}

TEST_F(CalibrationProgram, DrawsTheUndistortedGrid) {
  const Outcome outcome = run("calibration show left.yaml right.yaml --picture grid.svg");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("picture       grid.svg\n"));
  EXPECT_THAT(read("grid.svg"), AllOf(HasSubstr(">left: radial_tangential<"), HasSubstr(">right, undistorted<")));
  EXPECT_THAT(run("calibration show k.yaml --picture k.png").errors, HasSubstr("give it with --size"));
  EXPECT_EQ(run("calibration show left.yaml --picture left.yaml").exit_code, 2) << "the input";
}

TEST_F(CalibrationProgram, TakesTheImageSizeOfFilesWithoutIt) {
  EXPECT_THAT(run("calibration show k.yaml").output, HasSubstr("unknown image size"));
  EXPECT_THAT(run("calibration convert k.yaml -o k2.yaml").errors, HasSubstr("give it with --size"));
  EXPECT_EQ(run("calibration convert k.yaml --size 752x480 -o k2.yaml").exit_code, 0);
  EXPECT_THAT(run("calibration show k2.yaml").output, HasSubstr("pinhole, 752x480"));
  EXPECT_THAT(run("calibration show k.yaml --size 200x100").errors, HasSubstr("--size must be the size"));
  EXPECT_EQ(run("calibration show k.yaml --size large").exit_code, 2);
}

TEST_F(CalibrationProgram, ShowsAllCamerasWithoutRelativePoses) {
  const std::string rest = ", D: [0, 0, 0, 0], width: 752, height: 480}\n";
  const std::string text = "a: {K: [458, 0, 367, 0, 457, 248, 0, 0, 1]" + rest +
                           "b: {K: [500, 0, 367, 0, 500, 248, 0, 0, 1]" + rest +
                           "c: {K: [600, 0, 367, 0, 600, 248, 0, 0, 1]" + rest;
  write("cameras.yaml", text);
  const Outcome outcome = run("calibration show cameras.yaml");
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(
      outcome.output,
      AllOf(HasSubstr("camera        a: pinhole, 752x480, fx 458.000"), HasSubstr("c: pinhole, 752x480, fx 600"),
            HasSubstr("note          no relative poses: usable with one camera, as cameras.yaml#a\n")));
  EXPECT_EQ(json::parse(run("calibration show cameras.yaml --json").output).at("cameras").at("b").at("fx"), 500.0);
  EXPECT_THAT(run("calibration show cameras.yaml#b").output, HasSubstr("left          pinhole, 752x480, fx 500.000"));
  EXPECT_EQ(run("calibration convert cameras.yaml -o one.yaml").exit_code, 3) << "no camera is chosen";
  EXPECT_EQ(run("calibration convert cameras.yaml#b -o one.yaml").exit_code, 0);
  EXPECT_EQ(run("calibration convert cameras.yaml#b -o cameras.yaml").exit_code, 2) << "the input";
  EXPECT_EQ(read("cameras.yaml"), text);
}

TEST_F(CalibrationProgram, ReportsFilesOfOtherKinds) {
  write("text.yaml", "a: 1\n");
  const Outcome outcome = run("calibration show text.yaml");
  EXPECT_EQ(outcome.exit_code, 3);
  EXPECT_THAT(outcome.errors, HasSubstr("text.yaml: is not a supported calibration file"));
  EXPECT_EQ(run("calibration").exit_code, 2);
}

}  // namespace
}  // namespace byre::cli
