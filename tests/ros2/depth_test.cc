// `byre node` with a depth camera driven by other vendors' programs.

#include "mapped_recording.h"
#include "node_fixture.h"

#include <cstring>
#include <iomanip>

#include <gmock/gmock.h>
#include <opencv2/imgcodecs.hpp>

namespace byre::testing_ros2 {
namespace {

using testing::HasSubstr;
using std::chrono_literals::operator""ms;
using std::chrono_literals::operator""s;

// Depths along the optical axis at the centres of the pixels. The last row is invalid.
DepthImage rendered_depth(const PixelRays& rays, const Pose& world_from_camera, double units_per_metre) {
  const RenderedRoom room({});
  const Eigen::Matrix3f rotation = world_from_camera.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f origin = world_from_camera.translation.cast<float>();
  DepthImage depth{rays.width(), rays.height(), {}};
  for (int row = 0; row < depth.height; ++row) {
    for (int column = 0; column < depth.width; ++column) {
      const auto corners = row + 1 < depth.height ? rays.corners(column, row) : std::nullopt;
      const double metres = corners ? room.hit(origin, rotation * corners->at(0.5f, 0.5f)).distance : 0.0;
      depth.units.push_back(static_cast<std::uint16_t>(std::lround(metres * units_per_metre)));
    }
  }
  return depth;
}

class DepthNode : public ByreNode {
 protected:
  using Writer = eprosima::fastdds::dds::DataWriter;

  // settings: of images, indented, and groups after them.
  std::string mapping_with_depth(const std::string& settings) const {
    return "slam:\n  task: map\n  workers: repeatable\n  save: " + (folder_ / "made.byre").string() +
           "\nimages:\n  right: ''\n  depth: /depth/image\n  reliable: true\n  pair_wait: 0.2\n" + settings;
  }
  // Settles the writers, as the first message of each may be lost: the node has the frame of the left images, and the
  // format of the depth images.
  bool is_ready(NodeProcess& node, Writer* depth, const sensor_msgs::msg::Image& any) {
    return is_ready(node, depth) && send_acknowledged(depth, any) && send_acknowledged(depth, any);
  }
  bool is_ready(NodeProcess& node, Writer* depth) {
    sensor_msgs::msg::Image none = image_message({1, 1, {0}}, {}, "left_optical");
    none.encoding("none");
    return node.is_running() && diagnostics_.first() && FastPeer::has_subscriber(left_) &&
           FastPeer::has_subscriber(depth) && send_acknowledged(left_, none) && send_acknowledged(left_, none);
  }
  // Sends a left image and waits for the answer of the node: the position of its odometry, if it has any.
  std::optional<Eigen::Vector3d> position_after(sensor_msgs::msg::Image left) {
    left_->write(&left);
    const Timestamp time = time_of(left.header().stamp());
    const std::string part = "\"time_ns\":" + std::to_string(time.count()) + ",";
    if (!health_.find([&](const auto& text) { return text.data().find(part) != std::string::npos; })) return {};
    const auto is_of_frame = [&](const auto& message) { return time_of(message.header().stamp()) == time; };
    const auto odometry = odometry_.find(is_of_frame, 1s);
    return odometry ? std::optional(vector_of(odometry->pose().pose().position())) : std::nullopt;
  }
  Writer* images(const std::string& topic) {
    return peer_.writer(topic, TypeSupport(new sensor_msgs::msg::ImagePubSubType), kVolatile);
  }
  void expect_positions(const std::vector<std::optional<Eigen::Vector3d>>& found,
                        const std::vector<FrameReport>& expected) {
    int compared = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      ASSERT_EQ(found[i].has_value(), expected[i].odometry_from_body.has_value()) << "frame " << i;
      if (!found[i]) continue;
      EXPECT_LT((*found[i] - expected[i].odometry_from_body->translation).norm(), 1e-6) << "frame " << i;
      ++compared;
    }
    EXPECT_GT(compared, 15);
    EXPECT_GT((*found.back() - *found[found.size() / 2]).norm(), 0.01) << "metres: the camera moves";
  }

  // Sends the first frames of a recording with registered depth, in colour and in metres, one after the answer to
  // another, and compares the poses with those of Slam on the recording.
  void expect_poses_of(Recording& recording, const fs::path& calibration, int frames) {
    ASSERT_TRUE(recording.calibration().depth);
    Slam slam = Slam::mapping(recording.calibration(), Room::options());
    NodeProcess node(folder_,
                     mapping_with_depth("  pair_tolerance: 0.02\ncalibration:\n  file: " + calibration.string() + "\n"),
                     domain_);
    Writer* const depths = images("rt/depth/image");
    const double units = recording.calibration().depth->units_per_metre;
    std::optional<DepthImage> any;
    for (int i = 0; i < frames && !any; ++i) any = recording.read(i)->depth;
    ASSERT_TRUE(is_ready(node, depths, depth_message(any.value(), units, {}, "left_optical"))) << node.stderr_output();
    ASSERT_TRUE(diagnosis(diagnostics_, "byre: localisation", "no frame has been tracked yet")) << node.stderr_output();
    std::vector<FrameReport> expected;
    std::vector<std::optional<Eigen::Vector3d>> found;
    for (int i = 0; i < frames; ++i) {
      const ImageFrame frame = *recording.read(i);
      expected.push_back(slam.process(view_of(frame)));
      const bool is_sent = !frame.depth || send_acknowledged(depths, depth_message(*frame.depth, units,
                                                                                   frame.time + 4ms, "left_optical"));
      ASSERT_TRUE(is_sent);
      sensor_msgs::msg::Image colour = image_message(frame.left, frame.time, "left_optical");
      colour.encoding("rgb8");
      colour.step(3 * colour.width());
      colour.data().clear();
      for (const std::uint8_t grey : frame.left.pixels) colour.data().insert(colour.data().end(), 3, grey);
      found.push_back(position_after(colour));
    }
    expect_positions(found, expected);
    EXPECT_EQ(node.stop(), 0);
    EXPECT_TRUE(fs::exists(folder_ / "made.byre"));
  }

  Texts health_{peer_, "rt/byre/health", kVolatile};
  Writer* left_ = images("rt/left/image_raw");
};

// TUM folder of the room with a depth image for most frames, 4 ms after the colour image.
class RgbdFolder {
 public:
  static constexpr int kFrames = 24;

  RgbdFolder(const fs::path& folder, const Calibration& pair) : folder_(folder) {
    const RenderedFixture rendered("byre_ros2_depth", kFrames, 20.0);
    const auto recording = open_recording(rendered.folder(), {});
    const PixelRays rays(pair.left);
    fs::create_directories(folder / "rgb");
    fs::create_directories(folder / "depth");
    std::ofstream colours(folder / "rgb.txt"), depths(folder / "depth.txt");
    colours << std::fixed << std::setprecision(6), depths << std::fixed << std::setprecision(6);
    for (int i = 0; i < kFrames; ++i) {
      const ImageFrame frame = *recording->read(i);
      const std::string name = std::to_string(i) + ".png";
      colours << to_seconds(frame.time) << " rgb/" << name << "\n";
      fs::copy_file(rendered.image("cam0", static_cast<std::size_t>(i)), folder / "rgb" / name);
      if (i % 5 == 4) continue;
      const Pose& world_from_body = rendered.truth()[static_cast<std::size_t>(i)].world_from_body;
      DepthImage depth = rendered_depth(rays, world_from_body * pair.body_from_left, 5000.0);
      depths << to_seconds(frame.time + 4ms) << " depth/" << name << "\n";
      cv::imwrite(folder / "depth" / name, cv::Mat(depth.height, depth.width, CV_16UC1, depth.units.data()));
    }
    Calibration colour = pair;
    colour.right.reset();
    std::ofstream(folder / "camera.yaml") << write_calibration(colour);
  }

  std::unique_ptr<Recording> open() const { return open_recording(folder_, {}); }

 private:
  fs::path folder_;
};

TEST_F(DepthNode, PublishesThePosesOfTheFolderOfAnRgbdRecording) {
  const RgbdFolder folder(folder_ / "rgbd", euroc_like_calibration(4));
  expect_poses_of(*folder.open(), folder_ / "rgbd/camera.yaml", RgbdFolder::kFrames);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: cameras", "depth images are missing: 1 of the last"))
      << "one frame in five has none";
}

TEST_F(DepthNode, PublishesThePosesOfTheFolderOfARealRecording) {
  const auto folder = find_recording("tum/freiburg1_rpy");
  if (!folder) GTEST_SKIP() << missing("tum/freiburg1_rpy");
  expect_poses_of(*open_recording(*folder, {}), *folder / "calibration.yaml", 60);
}

sensor_msgs::msg::CameraInfo info_message(const Camera& camera, const std::string& frame) {
  sensor_msgs::msg::CameraInfo message;
  message.header().frame_id(frame);
  message.width(static_cast<std::uint32_t>(camera.width));
  message.height(static_cast<std::uint32_t>(camera.height));
  message.distortion_model("plumb_bob");
  message.d({camera.distortion.begin(), camera.distortion.begin() + 5});
  message.k({camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1});
  return message;
}

// A depth camera of another size, 50 mm to the right of the colour camera, as compressedDepth in millimetres.
TEST_F(DepthNode, PlacesADepthCameraByItsCameraInfoAndTransforms) {
  const RenderedFixture rendered("byre_ros2_own_depth", 24, 20.0);
  const auto recording = open_recording(rendered.folder(), {});
  const Pose left_from_depth{Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0}};
  const Camera lens{.width = 160, .height = 100, .fx = 90.0, .fy = 90.0, .cx = 80.0, .cy = 50.0};
  const Calibration pair = euroc_like_calibration(4);
  Calibration calibration{pair.left, std::nullopt, {}};
  calibration.depth.emplace();
  calibration.depth->camera = lens;
  calibration.depth->left_from_depth = left_from_depth;
  calibration.depth->units_per_metre = 1000.0;
  Slam slam = Slam::mapping(calibration, Room::options());

  const auto info_type = [] { return TypeSupport(new sensor_msgs::msg::CameraInfoPubSubType); };
  Writer* const left_info = peer_.writer("rt/left/camera_info", info_type(), kVolatile);
  Writer* const depth_info = peer_.writer("rt/depth/camera_info", info_type(), kVolatile);
  Writer* const fixed = peer_.writer("rt/tf_static", TypeSupport(new tf2_msgs::msg::TFMessagePubSubType), kLatched);
  Writer* const depths =
      peer_.writer("rt/depth/image", TypeSupport(new sensor_msgs::msg::CompressedImagePubSubType), kVolatile);
  NodeProcess node(folder_,
                   mapping_with_depth("  depth_compressed: true\ncalibration:\n  depth_info: /depth/camera_info\n"
                                      "frames:\n  mounting: camera\n"),
                   domain_);
  ASSERT_TRUE(is_ready(node, depths)) << node.stderr_output();
  ASSERT_TRUE(send_acknowledged(left_info, info_message(pair.left, "left_optical")));
  ASSERT_TRUE(send_acknowledged(depth_info, info_message(lens, "depth_optical")));
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation", "waiting for depth images on /depth/image"));
  EXPECT_TRUE(node.has_logged("no depth images on /depth/image for 5 s: 1 publisher connected, without a message"));

  const PixelRays rays(lens);
  const auto send_depth = [&](std::size_t i, Timestamp time) {
    const Pose world_from_left = rendered.truth()[i].world_from_body * pair.body_from_left;
    DepthImage depth = rendered_depth(rays, world_from_left * left_from_depth, 1000.0);
    sensor_msgs::msg::CompressedImage message;
    message.header().stamp(ros_time(time));
    message.header().frame_id("depth_optical");
    message.format("16UC1; compressedDepth png");
    cv::imencode(".png", cv::Mat(depth.height, depth.width, CV_16UC1, depth.units.data()), message.data());
    message.data().insert(message.data().begin(), 12, 0);
    depths->write(&message);
    return depth;
  };
  send_depth(0, 1s);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation",
                        "waiting for /tf_static from the frame of the left images, left_optical, to that of "
                        "/depth/camera_info, depth_optical"));
  tf2_msgs::msg::TFMessage mounting;
  geometry_msgs::msg::TransformStamped transform;
  transform.header().frame_id("left_optical");
  transform.child_frame_id("depth_optical");
  transform.transform().translation().x(0.05);
  transform.transform().rotation().w(1.0);
  mounting.transforms({transform});
  fixed->write(&mounting);
  ASSERT_TRUE(diagnosis(diagnostics_, "byre: localisation", "no frame has been tracked yet")) << node.stderr_output();

  std::vector<FrameReport> expected;
  std::vector<std::optional<Eigen::Vector3d>> found;
  for (int i = 0; i < recording->size(); ++i) {
    ImageFrame frame = *recording->read(i);
    frame.right.reset();
    frame.depth = send_depth(static_cast<std::size_t>(i), frame.time);
    expected.push_back(slam.process(view_of(frame)));
    found.push_back(position_after(image_message(frame.left, frame.time, "left_optical")));
  }
  expect_positions(found, expected);
  EXPECT_EQ(node.stop(), 0);
}

TEST_F(DepthNode, RefusesDepthThatIsNotRegistered) {
  NodeProcess node(folder_, mapping_with_depth("calibration:\n  file: " + Room::shared().calibration().string() + "\n"),
                   domain_);
  Writer* const depths = images("rt/depth/image");
  const DepthImage depth{188, 120, std::vector<std::uint16_t>(std::size_t{188} * 120, 2000)};
  ASSERT_TRUE(is_ready(node, depths, depth_message(depth, 1000.0, {}, "depth_optical"))) << node.stderr_output();
  const auto refusal = diagnosis(diagnostics_, "byre: cameras", "'depth_optical'");
  ASSERT_TRUE(refusal) << node.stderr_output();
  EXPECT_THAT(*refusal, HasSubstr("/depth/image: has the frame 'depth_optical', not that of the left images, "
                                  "'left_optical' (set images.depth to depth registered to the left images, or "
                                  "calibration.depth_info)"));
  sensor_msgs::msg::Image registered = depth_message(depth, 1000.0, {}, "left_optical");
  depths->write(&registered);
  EXPECT_TRUE(diagnosis(diagnostics_, "byre: localisation", "no frame has been tracked yet")) << node.stderr_output();
  EXPECT_EQ(node.stop(), 0);
}

}  // namespace
}  // namespace byre::testing_ros2
