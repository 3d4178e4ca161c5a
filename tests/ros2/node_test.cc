// `byre node` as another vendor's programs of ROS 2 meet it.

#include "byre/calibration_file.h"
#include "byre/map/map_file.h"
#include "byre/simulation/rendered_fixture.h"
#include "byre/slam.h"
#include "mapped_recording.h"
#include "node_scene.h"

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <thread>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace byre::testing_ros2 {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::AnyOf;
using testing::Eq;
using testing::HasSubstr;
using std::chrono_literals::operator""h;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

using Odometry = Inbox<nav_msgs::msg::Odometry, nav_msgs::msg::OdometryPubSubType>;
using Poses =
    Inbox<geometry_msgs::msg::PoseWithCovarianceStamped, geometry_msgs::msg::PoseWithCovarianceStampedPubSubType>;
using Transforms = Inbox<tf2_msgs::msg::TFMessage, tf2_msgs::msg::TFMessagePubSubType>;
using Diagnostics = Inbox<diagnostic_msgs::msg::DiagnosticArray, diagnostic_msgs::msg::DiagnosticArrayPubSubType>;
using Texts = Inbox<std_msgs::msg::String, std_msgs::msg::StringPubSubType>;
using Clouds = Inbox<sensor_msgs::msg::PointCloud2, sensor_msgs::msg::PointCloud2PubSubType>;
using Grids = Inbox<nav_msgs::msg::OccupancyGrid, nav_msgs::msg::OccupancyGridPubSubType>;
using Paths = Inbox<nav_msgs::msg::Path, nav_msgs::msg::PathPubSubType>;
using Graph =
    Inbox<rmw_dds_common::msg::ParticipantEntitiesInfo, rmw_dds_common::msg::ParticipantEntitiesInfoPubSubType>;
using eprosima::fastdds::dds::TypeSupport;

constexpr PeerQos kVolatile{true, false, 100};
constexpr PeerQos kLatched{true, true, 100};

// A room of made-up walls, with the calibration that the node is given, and what is mapped of it.
class Room {
 public:
  static const Room& shared() {
    static const Room room;
    return room;
  }

  fs::path calibration() const { return folder_ / "camchain.yaml"; }
  fs::path map() const { return folder_ / "room.byre"; }
  const std::vector<ImageFrame>& frames() const { return frames_; }
  // The PNG file of an image.
  std::vector<std::uint8_t> file(const std::string& camera, std::size_t frame) const {
    std::ifstream stream(rendered_.image(camera, frame), std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  // What a Slam of one's own makes of the frames.
  std::vector<FrameReport> tracked(Slam slam) const {
    std::vector<FrameReport> reports;
    for (const ImageFrame& frame : frames_) reports.push_back(slam.process(view_of(frame)));
    return reports;
  }
  static SlamOptions options() {
    SlamOptions options;
    options.workers = Workers::repeatable;
    return options;
  }

 private:
  Room() {
    const auto recording = open_recording(rendered_.folder(), {});
    for (int i = 0; i < recording->size(); ++i) frames_.push_back(*recording->read(i));
    std::ofstream(calibration()) << write_calibration(recording->calibration());
    Slam slam = Slam::mapping(read_calibration(calibration()), options());
    for (const ImageFrame& frame : frames_) slam.process(view_of(frame));
    slam.finish();
    slam.save(map());
  }

  RenderedFixture rendered_{"byre_ros2_room", 40, 20.0};
  fs::path folder_ = rendered_.folder();
  std::vector<ImageFrame> frames_;
};

class ByreNode : public testing::Test {
 protected:
  ByreNode() {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  ~ByreNode() override { fs::remove_all(folder_); }

  static std::string config(const std::string& slam, const std::string& more = {}) {
    return "slam:\n  workers: repeatable\n" + slam + "images:\n  reliable: true\n  pair_wait: 0.2\n" +
           "calibration:\n  file: " + Room::shared().calibration().string() + "\n" + more;
  }
  std::string mapping() const { return config("  task: map\n  save: " + (folder_ / "made.byre").string() + "\n"); }
  static std::string mission(const std::string& more = {}) {
    return config("  map: " + Room::shared().map().string() + "\n", more);
  }

  // Whether all have found one another. Endpoints are told in the order in which they were made: where the node answers
  // a command, it knows the cameras' writers too, and where the answer arrives, so do its other messages.
  bool is_connected() {
    if (!feed_.is_heard() || !diagnostics_.first()) return false;
    for (int attempt = 0; attempt < 100; ++attempt) {
      command("hello");
      if (events_.find([](const auto& event) { return event.data().find("hello") != std::string::npos; }, 1s))
        return feed_.settle();
    }
    return false;
  }

  void command(const std::string& text) {
    std_msgs::msg::String message;
    message.data(text);
    command_->write(&message);
  }

  // Sends a frame and waits for what the node makes of it.
  std::optional<nav_msgs::msg::Odometry> answer_to(CameraFeed& feed, Odometry& odometry, const ImageFrame& frame,
                                                   Timestamp later = {}) const {
    feed.send(frame, later);
    return odometry.find([&](const auto& message) { return time_of(message.header().stamp()) == frame.time + later; });
  }

  // What a status of the diagnostics says, once it says such a thing.
  static std::optional<std::string> diagnosis(Diagnostics& diagnostics, const std::string& name,
                                              const std::string& part) {
    std::optional<std::string> text;
    diagnostics.find([&](const diagnostic_msgs::msg::DiagnosticArray& message) {
      for (const auto& status : message.status()) {
        if (status.name() == name && status.message().find(part) != std::string::npos) text = status.message();
      }
      return text.has_value();
    });
    return text;
  }

  fs::path folder_ = fs::path(testing::TempDir()) / ("byre_node." + std::to_string(getpid()));
  int domain_ = some_domain();
  FastPeer peer_{domain_};
  Odometry odometry_{peer_, "rt/byre/odometry", kVolatile};
  Diagnostics diagnostics_{peer_, "rt/diagnostics", kVolatile};
  Texts events_{peer_, "rt/byre/events", kVolatile};
  CameraFeed feed_{peer_};
  eprosima::fastdds::dds::DataWriter* command_ =
      peer_.writer("rt/byre/command", TypeSupport(new std_msgs::msg::StringPubSubType), kVolatile);
};

TEST_F(ByreNode, GivesEachFrameThePosesThatSlamGives) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::mapping(read_calibration(room.calibration()), Room::options()));
  Clouds points(peer_, "rt/byre/points", kLatched);
  NodeProcess node(folder_, mapping(), domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const auto odometry = answer_to(feed_, odometry_, room.frames()[i]);
    ASSERT_TRUE(odometry.has_value()) << "frame " << i << "\n" << node.said();
    ASSERT_TRUE(expected[i].odometry_from_body.has_value());
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected[i].odometry_from_body->translation).norm(), 1e-6) << "frame " << i;
    EXPECT_EQ(odometry->header().frame_id(), "odom");
    EXPECT_EQ(odometry->child_frame_id(), "base_link");
  }
  EXPECT_TRUE(points.find([](const auto& cloud) { return cloud.width() > 100; })) << "of the map that grows";
  EXPECT_EQ(node.stop(), 0);
  EXPECT_TRUE(fs::exists(folder_ / "made.byre")) << "what was mapped is kept at the end";
}

// The node's poses of the frames, as it publishes them one by one.
TEST_F(ByreNode, GivesEachFrameOfAMissionThePoseInTheMapThatSlamGives) {
  const Room& room = Room::shared();
  const std::vector<FrameReport> expected =
      room.tracked(Slam::on_map(read_calibration(room.calibration()), room.map(), Room::options()));
  Poses poses(peer_, "rt/byre/pose", kLatched);
  Transforms transforms(peer_, "rt/tf", kVolatile);
  Texts health(peer_, "rt/byre/health", kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  for (const FrameReport& report : expected) {
    const auto index = static_cast<std::size_t>(&report - expected.data());
    feed_.send(room.frames()[index]);
    const std::string time = "\"time_ns\":" + std::to_string(report.time.count());
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time + ",") != std::string::npos; }))
        << "frame " << index << "\n"
        << node.said();
  }
  int compared = 0;
  for (const FrameReport& report : expected) {
    if (report.health.verdict == Verdict::untrusted) continue;
    const auto pose = poses.find([&](const auto& message) { return time_of(message.header().stamp()) == report.time; });
    ASSERT_TRUE(pose.has_value());
    EXPECT_LT((vector_of(pose->pose().pose().position()) - report.map_from_body->translation).norm(), 1e-6);
    ++compared;
  }
  EXPECT_GT(compared, 20);
  const FrameReport& last = expected.back();
  ASSERT_NE(last.health.verdict, Verdict::untrusted);
  const auto pose = poses.find([&](const auto& message) { return time_of(message.header().stamp()) == last.time; });
  ASSERT_TRUE(pose.has_value());
  EXPECT_LT((vector_of(pose->pose().pose().position()) - last.map_from_body->translation).norm(), 1e-6);
  const Matrix6 turned = [&] {
    Matrix6 turn = Matrix6::Zero();
    turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = last.map_from_body->rotation.toRotationMatrix();
    return Matrix6(turn * last.covariance * turn.transpose());
  }();
  EXPECT_NEAR(pose->pose().covariance()[1], turned(0, 1), 1e-12);
  EXPECT_NEAR(pose->pose().covariance()[35], turned(5, 5), 1e-12);
  EXPECT_TRUE(transforms.find([](const auto& message) {
    return message.transforms().size() == 2 && message.transforms()[0].header().frame_id() == "map" &&
           message.transforms()[0].child_frame_id() == "odom" &&
           message.transforms()[1].child_frame_id() == "base_link";
  }));
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, FindsItselfInAMapAndTellsLateJoiners) {
  const Room& room = Room::shared();
  std::ofstream(folder_ / "plan.pgm") << "P5\n3 2\n255\n" << std::string("\xff\x00\xff\x80\xff\x00", 6);
  std::ofstream(folder_ / "plan.yaml") << "image: plan.pgm\nresolution: 0.5\norigin: [-1, 2, 0]\n";
  StoredMap stored = load_map(room.map());
  stored.plan = PlanRegistration{"plan.yaml", {1.0, {Eigen::Quaterniond::Identity(), {0.0, 0.0, 10.0}}}};
  save_map(stored, folder_ / "on_plan.byre");
  NodeProcess node(folder_, config("  map: on_plan.byre\n  plan: plan.yaml\n"), domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  for (const ImageFrame& frame : room.frames()) {
    feed_.send(frame);
    std::this_thread::sleep_for(30ms);
  }
  Poses early(peer_, "rt/byre/pose", kLatched);
  ASSERT_TRUE(early.find([&](const auto& message) {
    return time_of(message.header().stamp()) == room.frames().back().time;
  })) << node.said();

  FastPeer late(domain_);
  Poses poses(late, "rt/byre/pose", kLatched);
  Transforms fixed(late, "rt/tf_static", kLatched);
  Clouds points(late, "rt/byre/points", kLatched);
  Grids grids(late, "rt/map", kLatched);
  Texts events(late, "rt/byre/events", kLatched);
  Paths paths(late, "rt/byre/path", kLatched);
  Graph graph(late, "ros_discovery_info", kLatched);
  const auto pose = poses.first();
  ASSERT_TRUE(pose.has_value());
  EXPECT_EQ(pose->header().frame_id(), "map");
  EXPECT_GT(pose->pose().pose().position().z(), 5.0) << "on the plan";
  const auto transforms = fixed.first();
  ASSERT_TRUE(transforms.has_value());
  ASSERT_EQ(transforms->transforms().size(), 2u);
  EXPECT_EQ(transforms->transforms()[0].child_frame_id(), "left_optical");
  const auto cloud = points.first();
  ASSERT_TRUE(cloud.has_value());
  EXPECT_GT(cloud->width(), 100u);
  ASSERT_EQ(cloud->data().size(), 12u * cloud->width());
  float z = 0.0f;
  std::memcpy(&z, cloud->data().data() + 8, 4);
  EXPECT_GT(z, 5.0f) << "on the plan";
  const auto grid = grids.first();
  ASSERT_TRUE(grid.has_value());
  EXPECT_EQ(grid->info().width(), 3u);
  EXPECT_THAT(grid->data(), testing::ElementsAre(255, 0, 100, 0, 100, 0)) << "from the lowest row up; 255: not known";
  EXPECT_DOUBLE_EQ(grid->info().origin().position().x(), -1.0);
  EXPECT_TRUE(
      events.find([](const auto& message) { return message.data().find("\"localised\"") != std::string::npos; }));
  EXPECT_TRUE(paths.find([](const auto& message) { return message.poses().size() > 20; }));
  const auto told = graph.find([](const auto& message) { return !message.node_entities_info_seq().empty(); });
  ASSERT_TRUE(told.has_value());
  EXPECT_EQ(told->node_entities_info_seq()[0].node_name(), "byre");
  EXPECT_EQ(told->node_entities_info_seq()[0].node_namespace(), "/");
  EXPECT_GE(told->node_entities_info_seq()[0].writer_gid_seq().size(), 9u);
  EXPECT_EQ(node.stop(), 0);
}

// A feeder that is killed in the middle of it all: this test in a process of its own, see below.
TEST(KilledFeeder, DISABLED_Feeds) {
  FastPeer peer(std::atoi(std::getenv("BYRE_TEST_DOMAIN")));
  CameraFeed feed(peer);
  ASSERT_TRUE(feed.is_heard());
  for (const ImageFrame& frame : Room::shared().frames()) {
    feed.send(frame);
    std::this_thread::sleep_for(50ms);
  }
}

TEST_F(ByreNode, GoesOnWithAFeederThatWasKilledAndBeganAgain) {
  NodeProcess node(folder_, mission(), domain_);
  const fs::path program = fs::read_symlink("/proc/self/exe");
  for (int attempt = 0; attempt < 2; ++attempt) {
    odometry_.forget();
    setenv("BYRE_TEST_DOMAIN", std::to_string(domain_).c_str(), 1);
    const pid_t feeder = fork();
    if (feeder == 0) {
      execl(program.c_str(), program.c_str(), "--gtest_also_run_disabled_tests", "--gtest_filter=KilledFeeder.*",
            "--gtest_brief=1", nullptr);
      _exit(127);
    }
    EXPECT_TRUE(odometry_.first()) << node.said();
    kill(feeder, SIGKILL);
    waitpid(feeder, nullptr, 0);
    EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "no image for"));
    diagnostics_.forget();
  }
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, NamesWhatIsWrongWithTheCameras) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  ASSERT_TRUE(answer_to(feed_, odometry_, frames[0]));

  for (std::size_t i = 1; i < 8; ++i) {
    feed_.send_left(frames[i]);
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "right images are missing"));

  diagnostics_.forget();
  for (std::size_t i = 8; i < 12; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i], 1h)) << "stamps went on";
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "stamps jumped by 3"));
  for (std::size_t i = 12; i < 16; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i])) << "stamps went back";
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "stamps jumped by -3"));

  diagnostics_.forget();
  for (int i = 0; i < 12; ++i) {
    ImageFrame frozen = frames[15];
    frozen.time += (i + 1) * 50ms;
    feed_.send(frozen);
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "repeats its image"));

  diagnostics_.forget();
  sensor_msgs::msg::Image broken = image_message(frames[12].left, frames[12].time, "left_optical");
  broken.height(100'000);
  feed_.send_left(broken);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "rows are not all there"));
  diagnostics_.forget();
  broken.height(1);
  broken.encoding("thermal");
  feed_.send_left(broken);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "'thermal'"));
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "no image for"));
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ObeysCommandsAndRefusesWaysOutOfTheFolder) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  ASSERT_TRUE(answer_to(feed_, odometry_, frames[0]));
  const auto answer = [&](const std::string& text) {
    command(text);
    const auto told = events_.find(
        [&](const auto& event) { return event.data().find("\"command\":\"" + text + "\"") != std::string::npos; });
    return told ? nlohmann::json::parse(told->data()) : nlohmann::json();
  };
  EXPECT_EQ(answer("load ../secret").at("done"), false);
  EXPECT_EQ(answer("load absent.byre").at("done"), false);
  EXPECT_EQ(answer("save").at("done"), false);
  EXPECT_EQ(answer("dance").at("done"), false);
  EXPECT_EQ(answer("load room.byre").at("done"), true);
  EXPECT_EQ(answer("relocalise").at("done"), true);
  for (std::size_t i = 1; i < 6; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i])) << i;
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, TakesItsCalibrationFromCameraInfoAndItsMountingFromTransforms) {
  const Room& room = Room::shared();
  Calibration calibration = read_calibration(room.calibration());
  NodeProcess node(
      folder_,
      "slam:\n  task: map\n  workers: repeatable\n  save: made.byre\nimages:\n  reliable: true\n  pair_wait: 0.2\n",
      domain_);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation", "waiting for camera info on /left/camera_info"));
  // Rectified axes: x along the baseline, as calibration of a pair chooses them.
  const Pose left_from_right = inverse(calibration.right->right_from_left);
  const Eigen::Vector3d x = left_from_right.translation.normalized();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitZ().cross(x).normalized();
  Eigen::Matrix3d left_turn;
  left_turn << x.transpose(), y.transpose(), x.cross(y).transpose();
  const Eigen::Matrix3d right_turn = left_turn * left_from_right.rotation.toRotationMatrix();
  const double fx = 100.0, baseline = left_from_right.translation.norm();
  const auto info = [&](const Camera& camera, const Eigen::Matrix3d& turn, double p3) {
    sensor_msgs::msg::CameraInfo message;
    message.header().frame_id("left_optical");
    message.width(static_cast<std::uint32_t>(camera.width));
    message.height(static_cast<std::uint32_t>(camera.height));
    message.distortion_model("plumb_bob");
    message.d({camera.distortion.begin(), camera.distortion.end()});
    message.k({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
    for (int i = 0; i < 9; ++i) message.r()[static_cast<std::size_t>(i)] = turn(i / 3, i % 3);
    message.p({fx, 0, 50, p3, 0, fx, 50, 0, 0, 0, 1, 0});
    return message;
  };
  const auto info_type = [] { return TypeSupport(new sensor_msgs::msg::CameraInfoPubSubType); };
  auto* const left_info = peer_.writer("rt/left/camera_info", info_type(), kVolatile);
  auto* const right_info = peer_.writer("rt/right/camera_info", info_type(), kVolatile);
  auto* const fixed =
      peer_.writer("rt/tf_static", TypeSupport(new tf2_msgs::msg::TFMessagePubSubType), {true, true, 1});
  ASSERT_TRUE(FastPeer::is_heard(left_info) && FastPeer::is_heard(right_info) && is_connected());
  tf2_msgs::msg::TFMessage mounting;
  geometry_msgs::msg::TransformStamped transform;
  transform.header().frame_id("base_link");
  transform.child_frame_id("left_optical");
  transform.transform().translation().x(0.3);
  transform.transform().rotation().w(1.0);
  mounting.transforms({transform});
  fixed->write(&mounting);
  sensor_msgs::msg::CameraInfo left = info(calibration.left, left_turn, 0.0);
  sensor_msgs::msg::CameraInfo right = info(calibration.right->camera, right_turn, -fx * baseline);

  calibration.body_from_left = {Eigen::Quaterniond::Identity(), {0.3, 0.0, 0.0}};
  const auto expected = room.tracked(Slam::mapping(calibration, Room::options()));
  // Images that come before the calibration are lost, and the one that tells the frame is.
  bool is_first_tracked = false;
  for (int i = 0; i < 20 && !is_first_tracked; ++i) {
    left_info->write(&left);
    right_info->write(&right);
    feed_.send(room.frames()[0]);
    is_first_tracked = odometry_.find([](const auto&) { return true; }, 1s).has_value();
  }
  ASSERT_TRUE(is_first_tracked) << node.said();
  for (std::size_t i = 1; i < 10; ++i) {
    const auto odometry = answer_to(feed_, odometry_, room.frames()[i]);
    ASSERT_TRUE(odometry.has_value()) << i;
    EXPECT_LT((vector_of(odometry->pose().pose().position()) - expected[i].odometry_from_body->translation).norm(),
              1e-6);
  }
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, TakesCompressedImagesOfOneCamera) {
  const Room& room = Room::shared();
  Calibration calibration = read_calibration(room.calibration());
  calibration.right.reset();
  Slam slam = Slam::on_map(calibration, room.map(), Room::options());
  auto* const left =
      peer_.writer("rt/left/compressed", TypeSupport(new sensor_msgs::msg::CompressedImagePubSubType), kVolatile);
  NodeProcess node(folder_,
                   "slam:\n  workers: repeatable\n  map: " + room.map().string() +
                       "\nimages:\n  left: /left/compressed\n  right: ''\n  compressed: true\n  reliable: true\n" +
                       "calibration:\n  file: " + room.calibration().string() + "\n",
                   domain_);
  ASSERT_TRUE(FastPeer::is_heard(left) && diagnostics_.first()) << node.said();
  std::vector<nav_msgs::msg::Odometry> answers;
  for (std::size_t i = 0; i < 20; ++i) {
    sensor_msgs::msg::CompressedImage message;
    message.header().stamp(ros_time(room.frames()[i].time));
    message.format("mono8; png compressed ");
    message.data(room.file("cam0", i));
    left->write(&message);
    const FrameReport expected = slam.process({view_of(room.frames()[i]).left});
    if (!expected.odometry_from_body) continue;
    const auto odometry =
        odometry_.find([&](const auto& answer) { return time_of(answer.header().stamp()) == room.frames()[i].time; });
    ASSERT_TRUE(odometry.has_value()) << i << "\n" << node.said();
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected.odometry_from_body->translation).norm(), 1e-6) << i;
    answers.push_back(*odometry);
  }
  EXPECT_GT(answers.size(), 10u);
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, LooksForTheRobotAnewWhereAPoseGivenByHandContradictsIts) {
  const Room& room = Room::shared();
  Poses poses(peer_, "rt/byre/pose", kLatched);
  auto* const hint = peer_.writer("rt/initialpose",
                                  TypeSupport(new geometry_msgs::msg::PoseWithCovarianceStampedPubSubType), kVolatile);
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected() && FastPeer::is_heard(hint)) << node.said();
  const auto answer_to_hint = [&](double x) {
    events_.forget();
    geometry_msgs::msg::PoseWithCovarianceStamped message;
    message.header().frame_id("map");
    message.pose().pose().position().x(x);
    hint->write(&message);
    const auto told = events_.find(
        [](const auto& event) { return event.data().find("\"command\":\"initial pose\"") != std::string::npos; });
    return told ? told->data() : "";
  };
  EXPECT_THAT(answer_to_hint(0.0), HasSubstr("is being looked for in the whole map"));
  for (std::size_t i = 0; i < 20; ++i) ASSERT_TRUE(answer_to(feed_, odometry_, room.frames()[i])) << node.said();
  ASSERT_TRUE(poses.first()) << node.said();
  EXPECT_THAT(answer_to_hint(0.0), HasSubstr("agrees with the present pose"));
  const auto before = odometry_.all().back();
  EXPECT_THAT(answer_to_hint(50.0), HasSubstr("looking for the robot"));
  const auto after = answer_to(feed_, odometry_, room.frames()[20]);
  ASSERT_TRUE(after.has_value()) << node.said();
  EXPECT_LT((vector_of(after->pose().pose().position()) - vector_of(before.pose().pose().position())).norm(), 0.1)
      << "odometry does not jump";
  EXPECT_EQ(node.stop(), 0);
}

// Seconds of processor time that a process has used.
double processor_seconds(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  long ticks = 0;
  for (int field = 1; file >> word && field <= 15; ++field) {
    if (field >= 14) ticks += std::stol(word);
  }
  return static_cast<double>(ticks) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

TEST_F(ByreNode, AnswersARecordingAsFastAsItCan) {
  const auto folder = find_recording("euroc/MH_01_easy");
  if (!folder) GTEST_SKIP() << missing("euroc/MH_01_easy");
  constexpr int kFrames = 60;
  const auto recording = open_recording(*folder, {.last = kFrames});
  std::ofstream(folder_ / "camchain.yaml") << write_calibration(recording->calibration());
  Slam slam = Slam::mapping(read_calibration(folder_ / "camchain.yaml"), Room::options());
  NodeProcess node(folder_,
                   "slam:\n  task: map\n  workers: repeatable\n  save: made.byre\nimages:\n  reliable: true\n"
                   "  pair_wait: 1\ncalibration:\n  file: camchain.yaml\n",
                   domain_);
  ASSERT_TRUE(is_connected()) << node.said();
  std::vector<double> milliseconds;
  for (int i = 0; i < kFrames; ++i) {
    const auto frame = recording->read(i);
    ASSERT_TRUE(frame.has_value());
    const auto begin = std::chrono::steady_clock::now();
    const auto odometry = answer_to(feed_, odometry_, *frame);
    milliseconds.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count());
    ASSERT_TRUE(odometry.has_value()) << "frame " << i << "\n" << node.said();
    const FrameReport expected = slam.process(view_of(*frame));
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected.odometry_from_body->translation).norm(), 1e-6) << "frame " << i;
  }
  std::ranges::sort(milliseconds);
  RecordProperty("median_ms", std::to_string(milliseconds[milliseconds.size() / 2]));
  RecordProperty("slowest_ms", std::to_string(milliseconds.back()));
  RecordProperty("processor_ms_a_frame", std::to_string(1e3 * processor_seconds(node.process()) / kFrames));
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, SurvivesAFloodOfImages) {
  FastPeer flooding(domain_);
  CameraFeed flood(flooding, false);
  std::string unreliable = mission();
  unreliable.replace(unreliable.find("reliable: true"), 14, "reliable: false");
  NodeProcess node(folder_, unreliable, domain_);
  ASSERT_TRUE(is_connected() && flood.is_heard()) << node.said();
  for (int i = 0; i < 2000; ++i) {  // a thousand a second
    ImageFrame frame = Room::shared().frames()[static_cast<std::size_t>(i) % 40];
    frame.time = std::chrono::milliseconds(i);
    flood.send(frame);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "were left out"));
  EXPECT_TRUE(answer_to(feed_, odometry_, Room::shared().frames()[0], 1h)) << "it goes on as before";
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
