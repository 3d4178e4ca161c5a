// Recordings of one camera with a depth camera, in TUM's format.

#include "byre/geometry/geometry_matchers.h"
#include "byre/io/bag/bag_scene.h"
#include "byre/io/recording/folder_scene.h"
#include "byre/recording.h"

#include <cstring>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kCamera =
    "resolution: [32, 24]\ncamera_model: pinhole\nintrinsics: [20, 20, 15.5, 11.5]\ndistortion_model: none\n";

// Five frames, 33 ms apart; the second and the last have no depth image near them, and the first has two.
class DepthRecording : public TestFolder {
 protected:
  DepthRecording() {
    write("rgb.txt", "100.000 rgb/0.png\n100.033 rgb/1.png\n100.066 rgb/2.png\n100.100 rgb/3.png\n100.200 rgb/4.png\n");
    write("depth.txt",
          "# depth\n99.990 depth/early.png\n100.004 depth/0.png\n100.078 depth/2.png\n100.085 depth/3.png\n"
          "100.160 depth/none.png\n");
    write("camera.yaml", kCamera);
    for (int i = 0; i < 5; ++i) write_image("rgb/" + std::to_string(i) + ".png", 32, 24, 10 * i + 10);
    write_depth("early", 999);
    for (const int i : {0, 2, 3}) write_depth(std::to_string(i), 1000 + i);
    write_depth("none", 888);
  }

  void write_depth(const std::string& name, int units, int width = 32, int height = 24) const {
    fs::create_directories(folder_ / "depth");
    cv::imwrite((folder_ / "depth" / (name + ".png")).string(), cv::Mat(height, width, CV_16U, cv::Scalar(units)));
  }

  std::unique_ptr<Recording> open(const OpenOptions& options = {}, const FrameRange& range = {}) const {
    return open_recording(folder_, range, options);
  }
  std::string open_error(const OpenOptions& options = {}) const {
    return error_of([&] { open(options); });
  }
};

// The value of the last pixel of each frame's depth image; -1 without one.
std::vector<int> units_of(Recording& recording) {
  std::vector<int> units;
  for (int i = 0; i < recording.size(); ++i) {
    const std::optional<ImageFrame> frame = recording.read(i);
    units.push_back(frame && frame->depth ? frame->depth->units.back() : -1);
  }
  return units;
}

TEST_F(DepthRecording, PairsFramesWithDepthImages) {
  for (const OpenOptions& options : {OpenOptions{}, OpenOptions{.camera = CameraChoice::rgbd}}) {
    const auto recording = open(options);
    EXPECT_EQ(recording->size(), 5) << "frames without depth count as frames";
    EXPECT_THAT(units_of(*recording), ElementsAre(1000, -1, 1002, 1003, -1));
    EXPECT_THAT(recording->warnings(), IsEmpty());
    EXPECT_EQ(camera_of(*recording, options), CameraChoice::rgbd);
    EXPECT_TRUE(recording->calibration().is_metric());
    EXPECT_FALSE(recording->read(0)->right);
  }
  EXPECT_THAT(units_of(*open({}, {.first = 2, .last = 4})), ElementsAre(1002, 1003));
}

TEST_F(DepthRecording, UsesTheTumRegistrationAndScaleByDefault) {
  const DepthCamera depth = open()->calibration().depth.value();
  EXPECT_FALSE(depth.camera);
  EXPECT_EQ(depth.units_per_metre, 5000.0);
  EXPECT_THAT(depth.left_from_depth, PoseNear(Pose{}, 1e-12, 1e-12));
}

TEST_F(DepthRecording, OpensAsOneCamera) {
  const OpenOptions left{.camera = CameraChoice::left};
  const auto recording = open(left);
  EXPECT_FALSE(recording->calibration().depth);
  EXPECT_EQ(camera_of(*recording, left), CameraChoice::left);
  EXPECT_THAT(units_of(*recording), ElementsAre(-1, -1, -1, -1, -1));
}

TEST_F(DepthRecording, WarnsIfAllDepthImagesAreMissing) {
  fs::remove_all(folder_ / "depth");
  const auto recording = open();
  EXPECT_FALSE(recording->calibration().depth);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("depth.txt: no listed image exists")));
  EXPECT_THAT(open_error({.camera = CameraChoice::rgbd}), HasSubstr("has no depth images"));
  fs::remove(folder_ / "depth.txt");
  EXPECT_THAT(open()->warnings(), IsEmpty());
  EXPECT_THAT(open_error({.camera = CameraChoice::rgbd}), HasSubstr("has no depth images"));
}

TEST_F(DepthRecording, SkipsUnusableDepthImages) {
  fs::remove(folder_ / "depth/0.png");
  write_depth("3", 1003, 16, 12);
  const auto recording = open();
  EXPECT_THAT(units_of(*recording), ElementsAre(-1, -1, 1002, -1, -1));
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("depth/0.png: does not exist"),
                                                 HasSubstr("depth/3.png: is 16x12 instead of 32x24")));
}

TEST_F(DepthRecording, RejectsImagesWithoutDepths) {
  for (const int i : {0, 2, 3}) write_image("depth/" + std::to_string(i) + ".png", 32, 24, 10);
  EXPECT_THAT(open_error(), HasSubstr("depth/0.png: is not a complete 16-bit image"));
  for (const int i : {0, 2, 3}) write_depth(std::to_string(i), 1000, 16, 12);
  EXPECT_THAT(open_error(), HasSubstr("camera.yaml: is 32x24, but the images are 16x12"));
  write("depth.txt", "100.0\n");
  EXPECT_THAT(open_error(), HasSubstr("depth.txt:1: has no name of an image file"));
}

TEST_F(DepthRecording, ReadsScaleNoiseAndPoseOfTheDepthCamera) {
  const std::string own =
      "depth_camera:\n  resolution: [16, 12]\n  camera_model: pinhole\n  distortion_model: none\n"
      "  intrinsics: [10, 10, 7.5, 5.5]\n"
      "  colour_from_depth: [[1, 0, 0, 0.025], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]\n";
  for (const int i : {0, 2, 3}) write_depth(std::to_string(i), 1000 + i, 16, 12);
  write("camera.yaml", kCamera + "depth_scale: 1000\ndepth_sigma: 0.004\n" + own);
  const auto recording = open();
  const DepthCamera depth = recording->calibration().depth.value();
  EXPECT_EQ(depth.units_per_metre, 1000.0);
  EXPECT_EQ(depth.sigma_at_one_metre, 0.004);
  ASSERT_TRUE(depth.camera);
  EXPECT_EQ(depth.camera->width, 16);
  EXPECT_EQ(depth.left_from_depth.translation.x(), 0.025);
  EXPECT_THAT(units_of(*recording), ElementsAre(1000, -1, 1002, 1003, -1));
}

TEST_F(DepthRecording, UsesDepthYamlIfTheCalibrationHasNoDepth) {
  write("depth.yaml", "depth_scale: 1000\n");
  EXPECT_EQ(open()->calibration().depth->units_per_metre, 1000.0);
  write("given.yaml", kCamera + "depth_scale: 2000\n");
  EXPECT_EQ(open({.calibration = folder_ / "given.yaml"})->calibration().depth->units_per_metre, 2000.0);
}

TEST_F(DepthRecording, ReportsTheInvalidField) {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"depth_scale: 0", "depth.yaml: depth_scale: is not a positive number"},
      {"depth_scale: many", "depth.yaml: depth_scale: is not a positive number"},
      {"depth_sigma: -1", "depth.yaml: depth_sigma: is not a positive number"},
      {"depth_camera: 1", "depth.yaml: depth_camera: has no named fields"},
      {"depth_camera: {camera_model: pinhole}", "depth.yaml: depth_camera.distortion_model: is missing"},
      {"depth_camera: {resolution: [16, 12], camera_model: pinhole, distortion_model: none, intrinsics: [9, 9, 8, 6]}",
       "depth.yaml: depth_camera.colour_from_depth: is missing"},
  };
  for (const auto& [content, message] : cases) {
    write("depth.yaml", content + "\n");
    EXPECT_THAT(open_error(), HasSubstr(message)) << content;
  }
}

TEST_F(DepthRecording, ReadsTimesInNanoseconds) {
  write("rgb.txt", "1403636579763555584 rgb/0.png\n1403636579813555456 rgb/1.png\n");
  fs::remove(folder_ / "depth.txt");
  EXPECT_THAT(open()->times(), ElementsAre(Timestamp(1403636579763555584), Timestamp(1403636579813555456)));
}

TEST_F(DepthRecording, DetectsTheBitsInUseOfItsImages) {
  for (const int bits : {10, 12, 14, 16}) {
    for (int i = 0; i < 5; ++i) {
      const int largest = (1 << bits) - 1;
      cv::imwrite((folder_ / "rgb" / (std::to_string(i) + ".png")).string(),
                  cv::Mat(24, 32, CV_16U, cv::Scalar(i == 3 ? largest : largest / 2)));
    }
    EXPECT_EQ(open()->read(3)->left.pixels.back(), 255) << bits;
    EXPECT_NEAR(open()->read(0)->left.pixels.back(), 127.5, 1.0) << bits;
  }
}

// Depths in metres, as a driver publishes them.
ros::Image in_metres(const DepthImage& depth, Timestamp time) {
  ros::Image message{{ros::to_time(time), "camera"}, 24, 32, "32FC1", 0, 4 * 32, {}};
  message.data.resize(depth.units.size() * sizeof(float));
  for (std::size_t i = 0; i < depth.units.size(); ++i) {
    const float metres = static_cast<float>(depth.units[i]) / 5000.0f;
    std::memcpy(message.data.data() + i * sizeof(float), &metres, sizeof(float));
  }
  return message;
}

// The images, depths, times and cameras that poses depend on.
TEST_F(DepthRecording, IsTheSameInABag) {
  const auto folder = open();
  ros::CameraInfo info{.header = {.frame_id = "camera"}, .height = 24, .width = 32, .distortion_model = "plumb_bob"};
  info.k = {20.0, 0.0, 15.5, 0.0, 20.0, 11.5, 0.0, 0.0, 1.0};
  std::vector<SceneMessage> messages = {scene_message("/rgb/camera_info", Timestamp(std::chrono::seconds(100)), info)};
  for (int i = 0; i < folder->size(); ++i) {
    const ImageFrame frame = folder->read(i).value();
    messages.push_back(
        scene_message("/rgb/image", frame.time,
                      ros::Image{{ros::to_time(frame.time), "camera"}, 24, 32, "mono8", 0, 32, frame.left.pixels}));
    if (!frame.depth) continue;
    const Timestamp time = frame.time + std::chrono::milliseconds(4);
    messages.push_back(scene_message("/depth/image", time, in_metres(*frame.depth, time)));
  }
  const BagBytes bytes = mcap_bytes(messages, "zstd");
  write("walk.mcap", std::string(reinterpret_cast<const char*>(bytes.data()), bytes.size()));
  const auto bag = open_recording(folder_ / "walk.mcap", {});
  EXPECT_THAT(bag->warnings(), IsEmpty());
  EXPECT_EQ(bag->calibration(), folder->calibration());
  EXPECT_EQ(bag->times(), folder->times());
  EXPECT_THAT(units_of(*bag), ElementsAre(1000, -1, 1002, 1003, -1));
  for (int i = 0; i < folder->size(); ++i) {
    const ImageFrame from_bag = bag->read(i).value(), from_folder = folder->read(i).value();
    EXPECT_EQ(from_bag.left.pixels, from_folder.left.pixels);
    ASSERT_EQ(from_bag.depth.has_value(), from_folder.depth.has_value());
    if (from_bag.depth) {
      EXPECT_EQ(from_bag.depth->units, from_folder.depth->units);
    }
  }
}

}  // namespace
}  // namespace byre
