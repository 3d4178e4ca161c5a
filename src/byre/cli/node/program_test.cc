// "byre node" without communication; tests/ros2 has the rest.

#include "byre/cli/shared/program_fixture.h"

#include <gmock/gmock.h>

namespace byre::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class NodeProgram : public ProgramTest {};

TEST_F(NodeProgram, PrintsHelp) {
  const Outcome help = run("node --help");
  EXPECT_EQ(help.exit_code, 0);
  EXPECT_THAT(help.output,
              AllOf(HasSubstr("--print-config"), HasSubstr("ROS_DOMAIN_ID"), HasSubstr("docs/reference/ros2.md")));
}

TEST_F(NodeProgram, ReadsItsPrintedSettings) {
  const Outcome first = run("node --print-config");
  EXPECT_EQ(first.exit_code, 0);
  EXPECT_THAT(first.output, HasSubstr("task: mission"));
  write("own.yaml", "slam:\n  map: barn.byre\ntopics:\n  pose: /amcl_pose\n");
  const Outcome printed = run("node --config own.yaml --print-config");
  EXPECT_EQ(printed.exit_code, 0) << printed.errors;
  EXPECT_THAT(printed.output, AllOf(HasSubstr("pose: /amcl_pose"), HasSubstr("map: barn.byre")));
}

TEST_F(NodeProgram, ReportsAllFaultsOfSettings) {
  write("robot.yaml", "slam:\n  map: barn.byre\n  worker: 3\nimages:\n  pair_wait: soon\n");
  const Outcome faults = run("node --config robot.yaml --check");
  EXPECT_EQ(faults.exit_code, 3);
  EXPECT_THAT(faults.output, IsEmpty());
  EXPECT_THAT(faults.errors, AllOf(HasSubstr("byre: error: robot.yaml:3: unknown setting slam.worker"),
                                   HasSubstr("byre: error: robot.yaml:5: images.pair_wait is 'soon'")));
  write("robot.yaml", "slam:\n  map: barn.byre\n");
  const Outcome files = run("node --config robot.yaml --check");
  EXPECT_EQ(files.exit_code, 3);
  EXPECT_THAT(files.errors, HasSubstr("byre: error: barn.byre: cannot be opened"));
  write("robot.yaml", "slam:\n  task: map\n  save: barn.byre\n");
  const Outcome sound = run("node --config robot.yaml --check");
  EXPECT_EQ(sound.exit_code, 0) << sound.errors;
  EXPECT_EQ(sound.output, "robot.yaml: no fault found\n");
}

TEST_F(NodeProgram, RefusesCommonMistakes) {
  write("camera.yaml",
        "cam0:\n  camera_model: pinhole\n  intrinsics: [400, 400, 376, 240]\n  distortion_model: radtan\n"
        "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [752, 480]\n");
  const std::string slam = "slam:\n  task: map\n  save: made.byre\n";
  for (const auto& [settings, message] : std::vector<std::pair<std::string, std::string>>{
           {"images:\n  left: /left/image_rect\n", "robot.yaml:5: images.left is of rectified images"},
           {"motion:\n  wheels: /byre/odometry\n", "robot.yaml:5: motion.wheels is topics.odometry"},
           {"calibration:\n  file: camera.yaml\n", "camera.yaml: is of one camera"}}) {
    write("robot.yaml", slam + settings);
    const Outcome outcome = run("node --config robot.yaml --check");
    EXPECT_EQ(outcome.exit_code, 3) << settings;
    EXPECT_THAT(outcome.errors, HasSubstr("byre: error: " + message));
  }
  write("robot.yaml", slam + "calibration:\n  file: pair.yaml\n");
  write("pair.yaml",
        "cam0:\n  camera_model: pinhole\n  intrinsics: [400, 400, 376, 240]\n  distortion_model: radtan\n"
        "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [752, 480]\n"
        "cam1:\n  camera_model: pinhole\n  intrinsics: [400, 400, 376, 240]\n  distortion_model: radtan\n"
        "  distortion_coeffs: [0, 0, 0, 0]\n  resolution: [752, 480]\n"
        "  T_cn_cnm1: [[1, 0, 0, -0.1], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n");
  const Outcome optical = run("node --config robot.yaml --check");
  EXPECT_EQ(optical.exit_code, 3);
  EXPECT_THAT(optical.errors, HasSubstr("pair.yaml: has no pose of the cameras in a body"));
  write("robot.yaml", slam + "calibration:\n  file: pair.yaml\nframes:\n  mounting: camera\n");
  EXPECT_EQ(run("node --config robot.yaml --check").exit_code, 0);
}

TEST_F(NodeProgram, NamesBadInput) {
  write("robot.yaml", "slam:\n  task: map\n  save: barn.byre\n");
  for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
           {"node", "byre: error: --config: is missing"},
           {"node --config absent.yaml", "byre: error: absent.yaml: "},
           {"node --config robot.yaml --ros-distro 'Humble 2'", "byre: error: --ros-distro: is not a release"}}) {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, StartsWith(message));
  }
}

}  // namespace
}  // namespace byre::cli
