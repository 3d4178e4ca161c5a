#include "byre/ros2/node/node_config.h"

#include "byre/calibration_file.h"

#include <algorithm>
#include <cstdlib>
#include <fstream>

#include <gmock/gmock.h>
#include <unistd.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<InputError> faults_in(const NodeConfig& config) {
  std::vector<std::string> notes;
  return faults_in_files(config, notes);
}

class NodeConfigFile : public testing::Test {
 protected:
  NodeConfigFile() { fs::create_directories(folder_); }
  ~NodeConfigFile() override { fs::remove_all(folder_); }

  NodeConfigReading read(const std::string& text) const {
    std::ofstream(folder_ / "robot.yaml") << text;
    return read_node_config(folder_ / "robot.yaml");
  }
  // All faults, one per line.
  std::string faults(const std::string& text) const {
    std::string lines;
    for (const InputError& fault : read(text).faults) lines += std::string(fault.what()) + "\n";
    return lines;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node_config." + std::to_string(getpid()));
};

TEST_F(NodeConfigFile, ResolvesPathsInItsFolderAndTopicsInTheNode) {
  const NodeConfig config =
      read(
          "node:\n  name: eyes\n  namespace: /barn\nslam:\n  map: barn.byre\n  save: /var/lib/byre/new.byre\n"
          "topics:\n  pose: /amcl_pose\n")
          .config;
  EXPECT_EQ(config.map, folder_ / "barn.byre");
  EXPECT_EQ(config.save, fs::path("/var/lib/byre/new.byre"));
  EXPECT_EQ(config.topic(config.odometry), "/barn/eyes/odometry");
  EXPECT_EQ(config.topic(config.pose), "/amcl_pose");
  EXPECT_EQ(config.topic(""), "");
}

TEST_F(NodeConfigFile, ReportsAllFaultsWithLineAndRemedy) {
  const std::string text =
      faults("slam:\n  map: barn.byre\n  worker: 3\nimages:\n  pair_wait: soon\n  left: two words\n");
  EXPECT_THAT(text, AllOf(HasSubstr("robot.yaml:3: unknown setting slam.worker"),
                          HasSubstr("robot.yaml:5: images.pair_wait is 'soon' (give from 0 to 1 seconds)"),
                          HasSubstr("robot.yaml:6: images.left is 'two words'")));
  EXPECT_EQ(std::ranges::count(text, '\n'), 3);
  EXPECT_THAT(faults("left: x\nslam:\n  map: m\n"), HasSubstr("is images.left meant?"));
}

TEST_F(NodeConfigFile, RejectsContradictingSettings) {
  EXPECT_THAT(faults("images:\n  left: /a\n"), HasSubstr("slam.map is missing"));
  EXPECT_THAT(faults("slam:\n  task: map\n"), HasSubstr("robot.yaml: slam.save is missing"));
  EXPECT_THAT(faults("slam:\n  task: map\n  save: s\n  map: m\n"), HasSubstr("robot.yaml:4: slam.map is not used"));
  EXPECT_THAT(faults("slam:\n  map: m\n  save: m\n"), HasSubstr("slam.save is the offline map"));
  EXPECT_THAT(faults("slam:\n  task: map\n  save: s\nimages:\n  right: ''\n"), HasSubstr("no metric scale"));
  EXPECT_THAT(faults("slam:\n  map: m\nframes:\n  mounting: file\n"),
              HasSubstr("robot.yaml:4: frames.mounting is file"));
  EXPECT_THAT(faults("slam:\n  map: m\nnode:\n  name: my-node\n"), HasSubstr("robot.yaml:4: node.name"));
  EXPECT_THAT(faults("slam:\n  map: m\n  plan: p\nframes:\n  in_plan: false\n"),
              HasSubstr("robot.yaml:3: slam.plan needs"));
  EXPECT_THAT(faults("slam:\n  map: m\n"), IsEmpty());
}

TEST_F(NodeConfigFile, AcceptsARegistryWithUpdatesOfOneMap) {
  EXPECT_THAT(faults("slam:\n  map: m\nregistry:\n  site: barn\n"),
              HasSubstr("robot.yaml:4: registry.site is set, but slam.update is off (set slam.update: automatic"));
  EXPECT_THAT(faults("slam:\n  map: m\n  update: automatic\nregistry:\n  database: postgresql:///byre\n"),
              HasSubstr("robot.yaml:5: registry.database is set, but registry.site is empty"));
  const std::string sound = "slam:\n  map: m\n  update: propose\nregistry:\n  site: barn\n  database: dbname=byre\n";
  EXPECT_THAT(faults(sound), IsEmpty());
  EXPECT_EQ(read(sound + "  interval: 5\n").config.registry.interval, 5.0);
  EXPECT_THAT(faults(sound + "  interval: 0.1\n"), HasSubstr("give 1 to 86400 seconds"));
  std::ofstream(folder_ / "m.yaml") << "maps:\n";
  EXPECT_THAT(faults_in(read("slam:\n  map: m.yaml\n  update: propose\nregistry:\n  site: barn\n").config)[0].what(),
              HasSubstr("registry.site: is of one map, but slam.map is a site"));
}

TEST_F(NodeConfigFile, AcceptsDepthImagesForOneCamera) {
  const std::string one = "slam:\n  task: map\n  save: s\nimages:\n  depth: /depth/image_raw\n";
  EXPECT_THAT(faults(one), HasSubstr("robot.yaml:5: images.depth is set, but so is images.right"));
  EXPECT_THAT(faults(one + "  right: ''\n"), IsEmpty()) << "a map of one camera with depth is metric";
  EXPECT_THAT(faults(one + "  right: ''\n  left: /depth/image_raw\n"),
              HasSubstr("robot.yaml:5: images.depth is the topic of the left images"));
  EXPECT_THAT(faults("slam:\n  map: m\ncalibration:\n  depth_info: /depth/camera_info\n"),
              HasSubstr("robot.yaml:4: calibration.depth_info is set, but images.depth is empty"));
}

TEST_F(NodeConfigFile, ReportsFaultsOfTheDepthCameraInTheCalibration) {
  std::ofstream(folder_ / "camera.yaml")
      << "camera_matrix: {rows: 3, cols: 3, data: [400, 0, 320, 0, 400, 240, 0, 0, 1]}\nimage_width: 640\n"
         "image_height: 480\ndistortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\ndepth_scale: 0\n";
  const std::string settings =
      "slam:\n  task: map\n  save: s.byre\nimages:\n  right: ''\n  depth: /d\ncalibration:\n  file: camera.yaml\n"
      "frames:\n  mounting: camera\n";
  const std::vector<InputError> found = faults_in(read(settings).config);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].what(), HasSubstr("camera.yaml: depth_scale: is not a positive number"));
}

TEST_F(NodeConfigFile, RejectsRectifiedImagesWithDistortion) {
  const std::string one = "slam:\n  map: m\nimages:\n  left: /camera/left/image_rect_color\n  right: ''\n";
  EXPECT_THAT(faults(one),
              HasSubstr("robot.yaml:4: images.left is of rectified images, but images.rectified is false"));
  EXPECT_THAT(faults(one + "  rectified: true\n"), IsEmpty());
  EXPECT_THAT(faults(one + "calibration:\n  file: rectified.yaml\n"), IsEmpty()) << "of rectified images";
  EXPECT_THAT(faults("slam:\n  map: m\nimages:\n  left: /rectory/image_raw\n"), IsEmpty());
}

TEST_F(NodeConfigFile, RejectsItsOwnTopicsAsInputs) {
  const std::string sound = "slam:\n  map: m\nmotion:\n";
  EXPECT_THAT(faults(sound + "  wheels: odometry\n"),
              HasSubstr("robot.yaml:4: motion.wheels is topics.odometry, which this node publishes"));
  EXPECT_THAT(faults(sound + "  wheels: /byre/odometry\n"), HasSubstr("motion.wheels is topics.odometry"));
  EXPECT_THAT(faults(sound + "  wheels: /odom\ntopics:\n  odometry: /odom\n"),
              HasSubstr("motion.wheels is topics.odometry"));
  EXPECT_THAT(faults(sound + "  wheels: /odometry\n"), IsEmpty());
  EXPECT_THAT(faults("slam:\n  map: m\ntopics:\n  pose: /initialpose\n"),
              HasSubstr("topics.initial_pose is topics.pose"));
  EXPECT_THAT(faults("slam:\n  map: m\nimages:\n  left: /a\n  right: /a\n"),
              HasSubstr("images.right is the topic of the left images"));
}

TEST_F(NodeConfigFile, ExpandsTheHomeFolder) {
  const char* const before = std::getenv("HOME");
  const std::string kept = before == nullptr ? "" : before;
  setenv("HOME", folder_.c_str(), 1);
  const NodeConfigReading reading = read(
      "slam:\n  task: extend\n  map: ~/maps/barn.byre\n  save: ~barn.byre\n  options: \"~\"\n"
      "calibration:\n  file: ~/camchain.yaml\nmqtt:\n  user: me\n  password_file: ~/password\n");
  EXPECT_EQ(read_node_config("~/robot.yaml").config.map, folder_ / "maps/barn.byre");
  setenv("HOME", kept.c_str(), 1);
  EXPECT_THAT(reading.faults, IsEmpty());
  EXPECT_EQ(reading.config.map, folder_ / "maps/barn.byre");
  EXPECT_EQ(reading.config.save, folder_ / "~barn.byre") << "a file name";
  EXPECT_EQ(reading.config.calibration, folder_ / "camchain.yaml");
  EXPECT_EQ(reading.config.fleet.password_file, folder_ / "password");
}

TEST_F(NodeConfigFile, ReportsFaultsOfFleetSettings) {
  const std::string sound = "slam:\n  map: m\nmqtt:\n  host: broker\n";
  EXPECT_THAT(faults(sound + "  port: 0\n"), HasSubstr("robot.yaml:5: mqtt.port is '0'"));
  EXPECT_THAT(faults(sound + "  rate: 100\n"), HasSubstr("robot.yaml:5: mqtt.rate is '100'"));
  EXPECT_THAT(faults(sound + "  serial_number: robot 7\n"),
              HasSubstr("robot.yaml:5: mqtt.serial_number contains characters other"));
  EXPECT_THAT(faults(sound + "  manufacturer: a/b\n"),
              HasSubstr("robot.yaml:5: mqtt.manufacturer contains characters other"));
  EXPECT_THAT(faults(sound + "  password_file: p\n"), HasSubstr("mqtt.password_file is set, but mqtt.user is empty"));
  EXPECT_THAT(faults(sound), IsEmpty());
}

TEST_F(NodeConfigFile, ReadsGridSettings) {
  const NodeConfig config =
      read("slam:\n  map: m\ngrid:\n  from_map: false\n  resolution: 0.1\n  footprint: 0.4\n  body_height: 0.9\n")
          .config;
  EXPECT_FALSE(config.has_grid_of_map);
  EXPECT_EQ(config.grid_resolution, 0.1);
  EXPECT_EQ(config.grid_footprint, 0.4);
  EXPECT_EQ(config.body_height, 0.9);
  EXPECT_THAT(faults("slam:\n  map: m\ngrid:\n  resolution: 0\n"), HasSubstr("robot.yaml:4: grid.resolution is '0'"));
}

TEST_F(NodeConfigFile, ReportsFaultsOfExtrinsics) {
  const std::string sound = "slam:\n  task: map\n  save: made.byre\n";
  EXPECT_THAT(faults(sound + "extrinsics:\n  camera_frame: left_optical\n"),
              HasSubstr("robot.yaml:5: extrinsics.camera_frame is set, but extrinsics.file is empty"));
  const auto found = [&](const std::string& content) {
    std::ofstream(folder_ / "mounts.yaml") << content;
    std::string text;
    for (const InputError& fault : faults_in(read(sound + "extrinsics:\n  file: mounts.yaml\n").config)) {
      text += fault.what();
    }
    return text;
  };
  EXPECT_THAT(found("base_from_camera:\n  translation_m: [400, 100, 900]\n  rpy_deg: [0, 0, 0]\ncamera_axes: body\n"),
              AllOf(HasSubstr("mounts.yaml"), HasSubstr("too far for a robot")));
  EXPECT_THAT(found("wheels:\n  scale: 1.01\n"), HasSubstr("mounts.yaml: has no pose of the camera"));
  EXPECT_THAT(found("base_from_camera:\n  translation_m: [0.4, 0.1, 0.9]\n  rpy_deg: [0, 0, 0]\ncamera_axes: body\n"),
              IsEmpty());
}

TEST_F(NodeConfigFile, EnablesTheFleetLinkOnlyWithABroker) {
  EXPECT_FALSE(fleet_options(read("slam:\n  map: m\n").config));
  std::ofstream(folder_ / "password") << "secret\nmore\n";
  const std::string text = "slam:\n  map: m\nnode:\n  name: eyes\nmqtt:\n  host: broker\n  user: me\n  password_file: ";
  const auto options = fleet_options(read(text + "password\n").config);
  ASSERT_TRUE(options);
  EXPECT_EQ(options->broker.password, "secret");
  EXPECT_EQ(options->identity.serial_number, "eyes");
  EXPECT_THROW(fleet_options(read(text + "absent\n").config), InputError);
}

TEST_F(NodeConfigFile, IsReadAsPrinted) {
  NodeConfig config =
      read("slam:\n  map: /m\n  workers: repeatable\nimages:\n  right: ''\nframes:\n  mounting: tf\n").config;
  const std::string printed = node_config_file(config);
  const NodeConfigReading again = read(printed);
  EXPECT_THAT(again.faults, IsEmpty());
  EXPECT_EQ(node_config_file(again.config), printed);
  EXPECT_EQ(again.config.extrinsics, ExtrinsicsSource::tf);
  EXPECT_FALSE(again.config.has_right());
}

TEST_F(NodeConfigFile, QuotesTextWithoutControlCharacters) {
  const NodeConfig config = read("slam:\n  map: \"/barn \\u009b2J: #1\\n.byre\"\n").config;
  const std::string printed = node_config_file(config);
  EXPECT_THAT(printed, HasSubstr(R"(map: "/barn \u009b2J: #1\n.byre"  # )"));
  EXPECT_EQ(read(printed).config.map, config.map);
}

TEST_F(NodeConfigFile, ReportsUnusableFiles) {
  const NodeConfig config =
      read("slam:\n  map: absent.byre\n  plan: absent.yaml\ncalibration:\n  file: absent.yml\n").config;
  const std::vector<InputError> found = faults_in(config);
  EXPECT_THAT(found, SizeIs(3));
  for (const InputError& fault : found) EXPECT_THAT(fault.what(), HasSubstr("absent"));
}

// Forward (z of the camera) is x of the base, right is -y, down is -z.
const Pose kForwardCamera{Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.3, 0.0, 0.5}};

TEST_F(NodeConfigFile, RefusesACameraAsBaseFrameUnlessChosen) {
  Calibration calibration;
  calibration.left = {.width = 752, .height = 480, .fx = 400.0, .fy = 400.0, .cx = 376.0, .cy = 240.0};
  calibration.right = {calibration.left, {Eigen::Quaterniond::Identity(), {-0.1, 0.0, 0.0}}};
  const auto found = [&](const std::string& more = {}) {
    std::ofstream(folder_ / "pair.yaml") << write_calibration(calibration);
    std::vector<std::string> notes;
    std::string text;
    const std::string settings = "slam:\n  task: map\n  save: made.byre\ncalibration:\n  file: pair.yaml\n";
    for (const InputError& fault : faults_in_files(read(settings + more).config, notes)) text += fault.what();
    for (const std::string& note : notes) text += note;
    return text;
  };
  EXPECT_THAT(found(), AllOf(HasSubstr("pair.yaml: has no pose of the cameras in a body"),
                             HasSubstr("base_link is the optical frame of the left camera")));
  EXPECT_THAT(found("frames:\n  mounting: camera\n"), IsEmpty());
  EXPECT_THAT(found("frames:\n  mounting: tf\n"), IsEmpty());
  calibration.body_from_left = {rotation_exp({0.02, 0.0, 0.01}), {0.005, 0.01, 0.0}};  // an IMU beside the camera
  EXPECT_THAT(found(), HasSubstr("the left camera looks along z of base_link, which is up"));
  calibration.body_from_left = kForwardCamera;
  EXPECT_THAT(found(), IsEmpty());
}

TEST_F(NodeConfigFile, ReportsACalibrationWithAnUnusualBaseline) {
  Calibration calibration;
  calibration.left = {.width = 752, .height = 480, .fx = 400.0, .fy = 400.0, .cx = 376.0, .cy = 240.0};
  calibration.right = {calibration.left, {Eigen::Quaterniond::Identity(), {-7.5, 0.0, 0.0}}};
  calibration.body_from_left = kForwardCamera;
  std::ofstream(folder_ / "pair.yaml") << write_calibration(calibration);
  const std::string settings = "images:\n  left: left\n  right: right\ncalibration:\n  file: pair.yaml\n";
  const std::vector<InputError> found = faults_in(read(settings).config);
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_THAT(found[0].what(), AllOf(HasSubstr("pair.yaml"), HasSubstr("calibration.baseline: 0.075")));
  EXPECT_THAT(faults_in(read(settings + "  baseline: 0.075\n").config), IsEmpty());
}

}  // namespace
}  // namespace byre
