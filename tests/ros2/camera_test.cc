// `byre node` with cameras driven by other vendors' programs: their calibrations, and faults in them.

#include "node_fixture.h"

#include <csignal>
#include <cstdlib>
#include <thread>

#include <gmock/gmock.h>
#include <sys/wait.h>

namespace byre::testing_ros2 {
namespace {

using testing::HasSubstr;
using std::chrono_literals::operator""h;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// Feeds the node from a separate process until killed.
TEST(KilledFeeder, DISABLED_Feeds) {
  FastPeer peer(std::atoi(std::getenv("BYRE_TEST_DOMAIN")));
  CameraFeed feed(peer);
  ASSERT_TRUE(feed.has_subscriber());
  for (const ImageFrame& frame : Room::shared().frames()) {
    feed.send(frame);
    std::this_thread::sleep_for(50ms);
  }
}

TEST_F(ByreNode, ContinuesAfterARestartOfTheCameraDriver) {
  NodeProcess node(folder_, mission(), domain_);
  const fs::path program = fs::read_symlink("/proc/self/exe");
  for (int attempt = 0; attempt < 2; ++attempt) {
    odometry_.clear();
    setenv("BYRE_TEST_DOMAIN", std::to_string(domain_).c_str(), 1);
    const pid_t feeder = fork();
    if (feeder == 0) {
      execl(program.c_str(), program.c_str(), "--gtest_also_run_disabled_tests", "--gtest_filter=KilledFeeder.*",
            "--gtest_brief=1", nullptr);
      _exit(127);
    }
    EXPECT_TRUE(odometry_.first()) << node.stderr_output();
    kill(feeder, SIGKILL);
    waitpid(feeder, nullptr, 0);
    EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "no image for"));
    diagnostics_.clear();
  }
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ReportsFaultsOfTheCameras) {
  const std::vector<ImageFrame>& frames = Room::shared().frames();
  NodeProcess node(folder_, mission(), domain_);
  ASSERT_TRUE(is_connected()) << node.stderr_output();
  ASSERT_TRUE(answer_to(feed_, odometry_, frames[0]));

  for (std::size_t i = 1; i < 8; ++i) {
    feed_.send_left(frames[i]);
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "right images are missing"));

  diagnostics_.clear();
  for (std::size_t i = 8; i < 12; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i], 1h)) << "stamps increase";
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "stamps jumped by 3"));
  for (std::size_t i = 12; i < 16; ++i) EXPECT_TRUE(answer_to(feed_, odometry_, frames[i])) << "stamps went back";
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "stamps jumped by -3"));

  diagnostics_.clear();
  for (int i = 0; i < 12; ++i) {
    ImageFrame frozen = frames[15];
    frozen.time += (i + 1) * 50ms;
    feed_.send(frozen);
    std::this_thread::sleep_for(50ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "repeated image"));

  diagnostics_.clear();
  sensor_msgs::msg::Image broken = image_message(frames[12].left, frames[12].time, "left_optical");
  broken.height(100'000);
  feed_.send_left(broken);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "are truncated or not whole pixels"));
  diagnostics_.clear();
  broken.height(1);
  broken.encoding("thermal");
  feed_.send_left(broken);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "'thermal'"));
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "no image for"));
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ReportsMissingInputsWithTheirPublishers) {
  const ImageFrame& frame = Room::shared().frames()[0];
  const int domain = some_domain();  // without the fixture's cameras
  FastPeer peer(domain);
  Diagnostics diagnostics(peer, "rt/diagnostics", kVolatile);
  const CameraFeed unreliable(peer, false);
  NodeProcess node(folder_, mission("motion:\n  wheels: /wheels\nframes:\n  odom_to_base: false\n"), domain);
  const auto left = diagnosis(diagnostics, "byre: inputs", "no left images on /left/image_raw for 5 s");
  ASSERT_TRUE(left) << node.stderr_output();
  EXPECT_THAT(*left, HasSubstr("1 publisher not connected: QoS best effort, volatile, required reliable, volatile; set "
                               "images.reliable: false"));
  EXPECT_THAT(*left, HasSubstr("no right images on /right/image_raw for 5 s"));
  EXPECT_THAT(*left, HasSubstr("no wheel odometry on /wheels for 5 s: no publisher"));
  EXPECT_THAT(*left, HasSubstr("no transform from odom to base_link on /tf for 5 s: no publisher"));
  EXPECT_TRUE(node.has_logged("no left images on /left/image_raw for 5 s: 1 publisher not connected"))
      << node.stderr_output();
  CameraFeed feed(peer);
  ASSERT_TRUE(feed.has_subscriber());
  const auto count = [&](const std::string& part) {
    const std::string log = node.stderr_output();
    int found = 0;
    for (std::size_t at = 0; (at = log.find(part, at)) != std::string::npos; ++at) ++found;
    return found;
  };
  for (int i = 0; i < 100 && count("left images received on /left/image_raw") == 0; ++i) {
    feed.send(frame, i * 100ms);
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_EQ(count("left images received on /left/image_raw"), 1) << node.stderr_output();
  EXPECT_EQ(count("no left images on"), 1) << node.stderr_output();
  EXPECT_EQ(count("no wheel odometry on"), 1) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, WarnsOfAPositiveBaselineInCameraInfo) {
  const auto info_type = [] { return TypeSupport(new sensor_msgs::msg::CameraInfoPubSubType); };
  auto* const left_info = peer_.writer("rt/left/camera_info", info_type(), kVolatile);
  auto* const right_info = peer_.writer("rt/right/camera_info", info_type(), kVolatile);
  NodeProcess node(folder_,
                   "slam:\n  task: map\n  save: made.byre\nimages:\n  rectified: true\nframes:\n  mounting: camera\n",
                   domain_);
  ASSERT_TRUE(FastPeer::has_subscriber(left_info) && FastPeer::has_subscriber(right_info)) << node.stderr_output();
  sensor_msgs::msg::CameraInfo info;
  info.width(188);
  info.height(120);
  info.distortion_model("plumb_bob");
  info.d({0, 0, 0, 0, 0});
  info.k({100, 0, 94, 0, 100, 60, 0, 0, 1});
  info.r({1, 0, 0, 0, 1, 0, 0, 0, 1});
  info.p({100, 0, 94, 0, 0, 100, 60, 0, 0, 0, 1, 0});
  const std::string warning = "/right/camera_info: the baseline in P is positive";
  for (int i = 0; i < 100 && node.stderr_output().find(warning) == std::string::npos; ++i) {
    info.p()[3] = 0.0;
    left_info->write(&info);
    info.p()[3] = 11.0;
    right_info->write(&info);
    std::this_thread::sleep_for(100ms);
  }
  EXPECT_TRUE(node.has_logged(warning)) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ReadsCameraInfoAndExtrinsicsFromTransforms) {
  const Room& room = Room::shared();
  Calibration calibration = read_calibration(room.calibration());
  NodeProcess node(
      folder_,
      "slam:\n  task: map\n  workers: repeatable\n  save: made.byre\nimages:\n  reliable: true\n  pair_wait: 0.2\n",
      domain_);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation", "waiting for camera info on /left/camera_info"));
  // Rectified axes: x along the baseline, as stereo calibration chooses them.
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
  ASSERT_TRUE(FastPeer::has_subscriber(left_info) && FastPeer::has_subscriber(right_info) && is_connected());
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
  // Images before the calibration are lost, and so is the one that determines the frame.
  bool is_first_tracked = false;
  for (int i = 0; i < 20 && !is_first_tracked; ++i) {
    left_info->write(&left);
    right_info->write(&right);
    feed_.send(room.frames()[0]);
    is_first_tracked = odometry_.find([](const auto&) { return true; }, 1s).has_value();
  }
  ASSERT_TRUE(is_first_tracked) << node.stderr_output();
  for (std::size_t i = 1; i < 10; ++i) {
    const auto odometry = answer_to(feed_, odometry_, room.frames()[i]);
    ASSERT_TRUE(odometry.has_value()) << i;
    EXPECT_LT((vector_of(odometry->pose().pose().position()) - expected[i].odometry_from_body->translation).norm(),
              1e-6);
  }
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, ProcessesCompressedImagesOfOneCamera) {
  const Room& room = Room::shared();
  Calibration calibration = read_calibration(room.calibration());
  calibration.right.reset();
  Slam slam = Slam::on_map(calibration, room.map(), Room::options());
  Texts health(peer_, "rt/byre/health", kVolatile);
  auto* const left =
      peer_.writer("rt/left/compressed", TypeSupport(new sensor_msgs::msg::CompressedImagePubSubType), kVolatile);
  NodeProcess node(folder_,
                   "slam:\n  workers: repeatable\n  map: " + room.map().string() +
                       "\nimages:\n  left: /left/compressed\n  right: ''\n  compressed: true\n  reliable: true\n" +
                       "calibration:\n  file: " + room.calibration().string() + "\n",
                   domain_);
  ASSERT_TRUE(FastPeer::has_subscriber(left) && diagnostics_.first()) << node.stderr_output();
  ASSERT_TRUE(send_acknowledged(left, sensor_msgs::msg::CompressedImage()));
  std::vector<nav_msgs::msg::Odometry> answers;
  for (std::size_t i = 0; i < 20; ++i) {
    sensor_msgs::msg::CompressedImage message;
    message.header().stamp(ros_time(room.frames()[i].time));
    message.format("mono8; png compressed ");
    message.data(room.file("cam0", i));
    left->write(&message);
    const FrameReport expected = slam.process({view_of(room.frames()[i]).left});
    // The node skips to the newest frame, so each frame waits for the answer to the previous one.
    const std::string time = "\"time_ns\":" + std::to_string(room.frames()[i].time.count()) + ",";
    ASSERT_TRUE(health.find([&](const auto& text) { return text.data().find(time) != std::string::npos; }))
        << "frame " << i << "\n"
        << node.stderr_output();
    if (!expected.odometry_from_body) continue;
    const auto odometry =
        odometry_.find([&](const auto& answer) { return time_of(answer.header().stamp()) == room.frames()[i].time; });
    ASSERT_TRUE(odometry.has_value()) << i << "\n" << node.stderr_output();
    const Eigen::Vector3d position = vector_of(odometry->pose().pose().position());
    EXPECT_LT((position - expected.odometry_from_body->translation).norm(), 1e-6) << i;
    answers.push_back(*odometry);
  }
  EXPECT_GT(answers.size(), 10u);
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(ByreNode, SurvivesAFloodOfImages) {
  FastPeer flooding(domain_);
  CameraFeed flood(flooding, false);
  std::string unreliable = mission();
  unreliable.replace(unreliable.find("reliable: true"), 14, "reliable: false");
  NodeProcess node(folder_, unreliable, domain_);
  ASSERT_TRUE(is_connected() && flood.has_subscriber()) << node.stderr_output();
  for (int i = 0; i < 2000; ++i) {  // a thousand per second
    ImageFrame frame = Room::shared().frames()[static_cast<std::size_t>(i) % 40];
    frame.time = std::chrono::milliseconds(i);
    flood.send(frame);
    std::this_thread::sleep_for(1ms);
  }
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "were replaced by newer ones"));
  // Images of an unreliable publisher may be lost, and the jumps of the flood may have cost the place.
  bool has_answered = false;
  for (std::size_t i = 0; i < 40 && !has_answered; ++i) {
    const ImageFrame& frame = Room::shared().frames()[i];
    feed_.send(frame, 1h);
    const auto is_answer = [&](const auto& message) { return time_of(message.header().stamp()) == frame.time + 1h; };
    has_answered = odometry_.find(is_answer, 1s).has_value();
  }
  EXPECT_TRUE(has_answered) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
