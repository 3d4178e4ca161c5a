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

TEST_F(NodeProgram, AcceptsTheArgumentsOfRos) {
  write("robot.yaml", "slam:\n  task: map\n  save: made.byre\n");
  write("parameters.yaml", "/**:\n  ros__parameters:\n    use_sim_time: false\n    frames: {map: world}\n");
  const Outcome printed =
      run("node --config robot.yaml --print-config --ros-args -r __node:=eyes -r __ns:=/robot1 --params-file "
          "parameters.yaml "
          "-p frames.odom:=wheels -r /tf:=tf --log-level warn");
  EXPECT_EQ(printed.exit_code, 0) << printed.errors;
  EXPECT_THAT(printed.output,
              AllOf(HasSubstr("name: eyes "), HasSubstr("namespace: /robot1 "), HasSubstr("map: world "),
                    HasSubstr("odom: wheels "), HasSubstr("tf: /robot1/tf ")));
  const Outcome checked =
      run("node --check --ros-args -p slam.task:=map -p slam.save:=made.byre --ros-args -r /map:=plan");
  EXPECT_EQ(checked.exit_code, 0) << checked.errors;
  EXPECT_EQ(checked.output, "byre node: no fault found\n");
  for (const auto& [arguments, message] : std::vector<std::pair<std::string, std::string>>{
           {"-r /scan:=/scan2", "-r /scan:=/scan2: /scan is not a topic of the node (give one of /left/image_raw"},
           {"-p speed:=3", "-p speed:=3: unknown setting speed"},
           {"--log-level loud", "--log-level loud: is not a level of this node"},
           {"--disable-rosout-logs", "--ros-args: has an argument without an effect on this node (give -r, -p"},
           {"-e /enclave", "--ros-args: has an argument without an effect"}}) {
    const Outcome outcome = run("node --config robot.yaml --ros-args " + arguments);
    EXPECT_EQ(outcome.exit_code, 3) << arguments;
    EXPECT_THAT(outcome.errors, HasSubstr("byre: error: " + message)) << arguments;
  }
  EXPECT_EQ(run("node --config robot.yaml -p slam.map:=m").exit_code, 2) << "without --ros-args";
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
