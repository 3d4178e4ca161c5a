#include "byre/ros2/node/ros_arguments.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class RosArgumentsOfNode : public testing::Test {
 protected:
  RosArgumentsOfNode() { fs::create_directories(folder_); }
  ~RosArgumentsOfNode() override { fs::remove_all(folder_); }

  std::string file(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return (folder_ / name).string();
  }
  // Settings of a mission with these arguments.
  NodeConfigReading read(const RosArguments& arguments, const std::string& more = {}) const {
    return read_node_config(fs::path(file("robot.yaml", "slam:\n  map: barn.byre\n" + more)), arguments);
  }
  static std::string text_of(const std::vector<InputError>& faults) {
    std::string lines;
    for (const InputError& fault : faults) lines += std::string(fault.what()) + "\n";
    return lines;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_ros_arguments." + std::to_string(getpid()));
};

TEST_F(RosArgumentsOfNode, NameTheNodeAndRemapItsTopics) {
  const NodeConfigReading reading = read({.remaps = {"/tf:=tf", "/tf_static:=tf_static", "/left/image_raw:=camera/left",
                                                     "~/odometry:=/odom", "__ns:=/robot1", "__node:=eyes"}});
  EXPECT_THAT(text_of(reading.faults), IsEmpty());
  const NodeConfig& config = reading.config;
  EXPECT_EQ(config.full_name(), "/robot1/eyes");
  EXPECT_EQ(config.topic(config.tf), "/robot1/tf");
  EXPECT_EQ(config.topic(config.tf_static), "/robot1/tf_static");
  EXPECT_EQ(config.topic(config.left), "/robot1/camera/left");
  EXPECT_EQ(config.topic(config.odometry), "/odom");
  EXPECT_EQ(config.topic(config.pose), "/robot1/eyes/pose");
  EXPECT_EQ(config.map, folder_ / "barn.byre");
}

TEST_F(RosArgumentsOfNode, SetParametersInTheOrderOfTheirPrecedence) {
  const std::string parameters = file("parameters.yaml",
                                      "/**:\n  ros__parameters:\n    use_sim_time: true\n    slam:\n      map: a.byre\n"
                                      "      save: b.byre\n"
                                      "/robot1/byre:\n  ros__parameters:\n    frames.map: world\n"
                                      "/robot2/byre:\n  ros__parameters:\n    frames.map: other\n    unknown: 1\n");
  const NodeConfigReading reading = read({.remaps = {"__ns:=/robot1"},
                                          .parameters = {"slam.save:=c.byre", "byre:frames.odom:=wheels"},
                                          .parameter_files = {parameters}},
                                         "frames:\n  map: building\n  base: base\n");
  EXPECT_THAT(text_of(reading.faults), IsEmpty());
  EXPECT_EQ(reading.config.map, folder_ / "a.byre") << "relative to the folder of the parameters";
  EXPECT_EQ(reading.config.save, fs::path("c.byre")) << "relative to the working directory";
  EXPECT_EQ(reading.config.map_frame, "world");
  EXPECT_EQ(reading.config.odom_frame, "wheels");
  EXPECT_EQ(reading.config.base_frame, "base");
}

TEST_F(RosArgumentsOfNode, AreSufficientWithoutSettings) {
  const NodeConfigReading reading = read_node_config(std::nullopt, {.parameters = {"slam.map:=/barn.byre"}});
  EXPECT_THAT(text_of(reading.faults), IsEmpty());
  EXPECT_EQ(reading.config.map, fs::path("/barn.byre"));
  EXPECT_FALSE(reading.config.file);
  EXPECT_THAT(text_of(read_node_config(std::nullopt, {.parameters = {"slam.save:=b"}}).faults),
              HasSubstr("byre node: slam.map is missing"));
}

TEST_F(RosArgumentsOfNode, ReportWhatHasNoEffect) {
  EXPECT_THAT(text_of(read({.remaps = {"/scan:=/scan2"}}).faults),
              AllOf(HasSubstr("-r /scan:=/scan2: /scan is not a topic of the node"), HasSubstr("/left/image_raw"),
                    HasSubstr("/byre/odometry")));
  EXPECT_THAT(text_of(read({.remaps = {"/tf"}}).faults), HasSubstr("-r /tf: has no :="));
  EXPECT_THAT(text_of(read({.remaps = {"/tf:=two words"}}).faults), HasSubstr("'/two words' is not a topic"));
  EXPECT_THAT(text_of(read({.remaps = {"amcl:/tf:=tf"}}).faults), HasSubstr("is for the node amcl"));
  EXPECT_THAT(text_of(read({.remaps = {"__ns:=robot1"}}).faults),
              HasSubstr("-r __ns:=robot1: node.namespace does not begin with a slash"));
  EXPECT_THAT(text_of(read({.parameters = {"slam.mop:=x"}}).faults),
              HasSubstr("-p slam.mop:=x: unknown setting slam.mop"));
  EXPECT_THAT(text_of(read({.parameters = {"images.pair_wait:=soon"}}).faults),
              HasSubstr("-p images.pair_wait:=soon: images.pair_wait is 'soon'"));
  EXPECT_THROW(read({.parameter_files = {file("other.yaml", "amcl:\n  ros__parameters:\n    a: 1\n")}}), InputError);
  EXPECT_THROW(read({.parameter_files = {file("plain.yaml", "slam:\n  map: a.byre\n")}}), InputError);
}

TEST_F(RosArgumentsOfNode, RefuseARemapToAnOwnTopic) {
  EXPECT_THAT(text_of(read({.remaps = {"/wheels:=/byre/odometry"}}, "motion:\n  wheels: /wheels\n").faults),
              HasSubstr("motion.wheels is topics.odometry"));
}

TEST_F(RosArgumentsOfNode, MoveTopicsIntoTheNamespace) {
  const std::string moved = "topics:\n  in_namespace: true\n  grid: /robot1/plan\n";
  const NodeConfig config = read({.remaps = {"__ns:=/robot1", "/tf:=tf"}}, moved).config;
  EXPECT_EQ(config.tf, "/robot1/tf");
  EXPECT_EQ(config.tf_static, "/robot1/tf_static");
  EXPECT_EQ(config.grid, "/robot1/plan") << "it is in the namespace";
  EXPECT_EQ(config.initial_pose, "/robot1/initialpose");
  const std::string printed = node_config_file(config);
  EXPECT_EQ(node_config_file(read_node_config(fs::path(file("printed.yaml", printed))).config), printed);
  EXPECT_EQ(read({}, moved).config.tf, "/tf") << "no namespace";
}

TEST(RosLogLevel, IsReadAsByRos) {
  EXPECT_EQ(log_level_of("warn", "byre"), LogLevel::warning);
  EXPECT_EQ(log_level_of("DEBUG", "byre"), LogLevel::info);
  EXPECT_EQ(log_level_of("byre:=error", "byre"), LogLevel::error);
  EXPECT_EQ(log_level_of("rcl:=error", "byre"), std::nullopt);
  EXPECT_EQ(log_level_of("loud", "byre"), std::nullopt);
}

}  // namespace
}  // namespace byre
