#include "byre/io/recording/bag_recording.h"

#include "byre/io/bag/bag_scene.h"
#include "byre/io/recording/folder_scene.h"
#include "byre/io/recording/timed_files.h"

#include <array>
#include <cstring>
#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr const char* kLeft = "/left/image_raw";
constexpr const char* kRight = "/right/image_raw";

Timestamp ms(int milliseconds) {
  return std::chrono::milliseconds(milliseconds);
}

ros::CameraInfo info(const std::string& frame, double p3 = 0.0) {
  ros::CameraInfo info{.header = {.frame_id = frame}, .height = 4, .width = 6, .distortion_model = "plumb_bob"};
  info.k = {5.0, 0.0, 2.5, 0.0, 5.0, 1.5, 0.0, 0.0, 1.0};
  info.r = {1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0};
  info.p = {5.0, 0.0, 2.5, p3, 0.0, 5.0, 1.5, 0.0, 0.0, 0.0, 1.0, 0.0};
  return info;
}

std::vector<SceneMessage> infos() {
  return {scene_message("/left/camera_info", ms(1000), info("left")),
          scene_message("/right/camera_info", ms(1000), info("left", -0.5))};
}

SceneMessage image_of_bag(const std::string& topic, int number, Timestamp stamp, Timestamp log_time) {
  return scene_message(topic, log_time, scene_image(number, stamp));
}

std::vector<SceneMessage> with_infos(std::vector<SceneMessage> messages) {
  for (SceneMessage& each : infos()) messages.push_back(std::move(each));
  return messages;
}

class BagRecordings : public BagFolderTest {
 protected:
  std::unique_ptr<Recording> open(const std::vector<SceneMessage>& messages, const OpenOptions& options = {},
                                  const FrameRange& range = {}) const {
    return open_recording(write("walk.mcap", mcap_bytes(messages, "zstd")), range, options);
  }
  std::string open_error(const std::vector<SceneMessage>& messages, const OpenOptions& options = {}) const {
    return error_of([&] { open(messages, options); });
  }
};

TEST_F(BagRecordings, ReturnImagesAtHeaderTimes) {
  const auto recording = open(with_infos(scene_messages()));
  EXPECT_THAT(recording->warnings(), IsEmpty());
  EXPECT_THAT(recording->times(), ElementsAre(ms(1000), ms(1050), ms(1100), ms(1150), ms(1200), ms(1250)));
  ASSERT_TRUE(recording->calibration().right.has_value());
  EXPECT_NEAR(recording->calibration().right->right_from_left.translation.x(), -0.1, 1e-12);
  for (const int index : {3, 0, 5}) {
    const std::optional<ImageFrame> frame = recording->read(index);
    ASSERT_TRUE(frame && frame->right);
    EXPECT_EQ(frame->time, ms(1000 + 50 * index));
    EXPECT_EQ(frame->left.pixels, scene_image(index, {}).data);
    EXPECT_EQ(frame->right->pixels, scene_image(100 + index, {}).data);
  }
}

TEST_F(BagRecordings, AreEqualInEveryBagFormat) {
  const std::vector<SceneMessage> messages = with_infos(scene_messages());
  write_db3(folder_ / "walk.db3", messages);
  for (const fs::path& path :
       {folder_ / "walk.db3", write("walk.bag", ros1_bytes(messages)), write("walk.mcap", mcap_bytes(messages, "-"))}) {
    EXPECT_EQ(guess_format(path), RecordingFormat::bag);
    const auto recording = open_recording(path, {});
    ASSERT_EQ(recording->size(), 6) << path;
    EXPECT_EQ(recording->read(2)->right->pixels, scene_image(102, {}).data) << path;
    EXPECT_EQ(recording->calibration(), open_recording(folder_ / "walk.mcap", {})->calibration());
    EXPECT_THAT(files_of_recording(path), ElementsAre(path));
  }
}

TEST_F(BagRecordings, KeepTheSelectedRange) {
  EXPECT_THAT(open(with_infos(scene_messages()), {}, {.first = 1, .last = 4, .stride = 2})->times(),
              ElementsAre(ms(1050), ms(1150)));
}

TEST_F(BagRecordings, PairImagesWithinTwoMilliseconds) {
  const auto recording =
      open(with_infos({image_of_bag(kLeft, 1, ms(1000), ms(1001)), image_of_bag(kRight, 2, ms(1002), ms(1002)),
                       image_of_bag(kLeft, 3, ms(1050), ms(1051)), image_of_bag(kRight, 4, ms(1053), ms(1053)),
                       image_of_bag(kLeft, 5, ms(1100), ms(1101)), image_of_bag(kRight, 6, ms(1098), ms(1102)),
                       image_of_bag(kRight, 7, ms(1100), ms(1103))}));
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("1 of 3 left images have no right image within 2 ms, "
                                                           "2 of 4 right images have no left image")));
  EXPECT_EQ(recording->read(0)->right->pixels, scene_image(2, {}).data);
  EXPECT_FALSE(recording->read(1)->right.has_value());
  EXPECT_THAT(recording->warnings().back(), HasSubstr("has no right image with the same time stamp"));
  EXPECT_EQ(recording->read(2)->right->pixels, scene_image(7, {}).data);
}

TEST_F(BagRecordings, RejectImagesWithoutPairs) {
  EXPECT_THAT(
      open_error(with_infos({image_of_bag(kLeft, 1, ms(1000), ms(1001)), image_of_bag(kRight, 2, ms(1025), ms(1026)),
                             image_of_bag(kLeft, 3, ms(1050), ms(1051))})),
      HasSubstr("no right image is within 2 ms of a left image; the median difference is 25.000 ms"));
}

TEST_F(BagRecordings, SortImagesByHeaderTimeAndReportIt) {
  const auto recording = open({image_of_bag(kLeft, 1, ms(1050), ms(1001)), image_of_bag(kLeft, 2, ms(1000), ms(1002)),
                               image_of_bag(kLeft, 3, ms(1050), ms(1003)), infos()[0]});
  EXPECT_THAT(recording->times(), ElementsAre(ms(1000), ms(1050)));
  EXPECT_EQ(recording->read(1)->left.pixels, scene_image(1, {}).data);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("1 images were recorded after later ones"),
                                                 HasSubstr("1 images have the time stamp of another one")));
}

TEST_F(BagRecordings, UseReceiveTimesWithoutHeaderTimes) {
  const auto recording =
      open({image_of_bag(kLeft, 1, ms(0), ms(1001)), image_of_bag(kLeft, 2, ms(0), ms(1051)), infos()[0]});
  EXPECT_THAT(recording->times(), ElementsAre(ms(1001), ms(1051)));
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("receive times are used for all images")));
}

// Pairs, 50 ms apart, each received 3 to 5 ms after it was taken. stamp, log: header stamps and receive times.
std::vector<SceneMessage> pairs_stamped(int count, const std::function<Timestamp(Timestamp)>& stamp,
                                        const std::function<Timestamp(Timestamp)>& log) {
  std::vector<SceneMessage> messages = infos();
  for (int i = 0; i < count; ++i) {
    const Timestamp taken = ms(1'000'000 + 50 * i);
    messages.push_back(image_of_bag(kLeft, i % 10, stamp(taken), log(taken + ms(3 + i % 3))));
    messages.push_back(image_of_bag(kRight, i % 10 + 10, stamp(taken), log(taken + ms(4 + i % 2))));
  }
  return messages;
}

void expect_steady_pairs(Recording& recording, int count, Timestamp tolerance) {
  ASSERT_EQ(recording.size(), count);
  for (int i = 0; i < count; ++i) {
    const auto frame = recording.read(i);
    ASSERT_TRUE(frame && frame->right) << i;
    EXPECT_EQ(frame->left.pixels, scene_image(i % 10, {}).data) << i;
    EXPECT_EQ(frame->right->pixels, scene_image(i % 10 + 10, {}).data) << i;
    EXPECT_LE(std::chrono::abs(frame->time - ms(1'000'000 + 50 * i)), tolerance) << i;
  }
}

Timestamp as_it_is(Timestamp time) {
  return time;
}

// NTP sets the clock of the computer back by 0.62 s, 1.5 s after the first pair.
Timestamp set_back(Timestamp time) {
  return time - (time >= ms(1'001'500) ? ms(620) : ms(0));
}

TEST_F(BagRecordings, ContinueAfterTheCameraClockIsSetBack) {
  const auto recording = open(pairs_stamped(60, set_back, as_it_is));
  expect_steady_pairs(*recording, 60, ms(0));
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("/left/image_raw: clock set back by 0.620 s at frame 30"),
                                                 HasSubstr("/right/image_raw: clock set back by 0.620 s at frame 30")));
  ASSERT_EQ(recording->time_corrections().clock_steps.size(), 1u);
  EXPECT_EQ(recording->time_corrections().clock_steps[0].by, ms(-620));
}

TEST_F(BagRecordings, ContinueAfterTheRecorderClockIsSetBackToo) {
  const std::vector<SceneMessage> messages = pairs_stamped(60, set_back, set_back);
  expect_steady_pairs(*open(messages), 60, ms(0));
  write_db3(folder_ / "walk.db3", messages);
  for (const fs::path& path : {folder_ / "walk.db3", write("walk.bag", ros1_bytes(messages))}) {
    expect_steady_pairs(*open_recording(path, {}), 60, ms(0));
  }
}

TEST_F(BagRecordings, KeepStampsIfOnlyTheRecorderClockIsSetBack) {
  const auto recording = open(pairs_stamped(60, as_it_is, set_back));
  expect_steady_pairs(*recording, 60, ms(0));
  EXPECT_FALSE(recording->time_corrections().any());
}

TEST_F(BagRecordings, ContinueIfPlayedInALoop) {
  const auto recording = open(pairs_stamped(
      60, [](Timestamp time) { return ms(1'000'000) + time % ms(1'000); }, as_it_is));
  expect_steady_pairs(*recording, 60, ms(0));
  EXPECT_EQ(recording->time_corrections().clock_steps.size(), 2u);
}

TEST_F(BagRecordings, UseReceiveTimesForStampsInWholeSeconds) {
  const auto recording = open(pairs_stamped(
      60, [](Timestamp time) { return time - time % std::chrono::seconds(1); }, as_it_is));
  expect_steady_pairs(*recording, 60, ms(5));
  EXPECT_EQ(recording->time_corrections().source, TimeSource::receive_times);
}

TEST_F(BagRecordings, InterpolateThreeZeroStamps) {
  for (const int first : {0, 20}) {
    const auto is_zero = [&](Timestamp time) {
      return time >= ms(1'000'000 + 50 * first) && time < ms(1'000'000 + 50 * (first + 3));
    };
    const auto recording = open(pairs_stamped(
        40, [&](Timestamp time) { return is_zero(time) ? ms(0) : time; }, as_it_is));
    expect_steady_pairs(*recording, 40, ms(0));
    EXPECT_EQ(recording->time_corrections().unstamped, 3);
  }
}

TEST_F(BagRecordings, SelectOneCameraOfAPair) {
  const std::vector<SceneMessage> messages = with_infos(scene_messages());
  const auto left = open(messages, {.camera = CameraChoice::left});
  EXPECT_FALSE(left->calibration().right.has_value());
  EXPECT_EQ(left->read(1)->left.pixels, scene_image(1, {}).data);
  const auto right = open(messages, {.camera = CameraChoice::right});
  EXPECT_FALSE(right->calibration().right.has_value());
  EXPECT_EQ(right->read(1)->left.pixels, scene_image(101, {}).data);
  EXPECT_THAT(open_error(messages, {.camera = CameraChoice::rgbd}), HasSubstr("has no depth images"));
}

TEST_F(BagRecordings, PreferTheGivenCalibrationToTheOneInTheFolder) {
  const std::string camera =
      "camera_matrix: {rows: 3, cols: 3, data: [4.0, 0, 2.5, 0, 4.0, 1.5, 0, 0, 1]}\nimage_width: 6\nimage_height: 4\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\ndistortion_model: plumb_bob\n";
  const std::vector<SceneMessage> images = {image_of_bag(kLeft, 1, ms(1000), ms(1001))};
  EXPECT_THAT(open_error(images), HasSubstr("has no camera info on topic /left/camera_info"));
  write("calibration.yaml", camera);
  EXPECT_EQ(open(images)->calibration().left.fx, 4.0);
  const std::vector<SceneMessage> with_info = {images[0], infos()[0]};
  EXPECT_EQ(open(with_info)->calibration().left.fx, 5.0);
  EXPECT_EQ(open(with_info, {.calibration = folder_ / "calibration.yaml"})->calibration().left.fx, 4.0);
}

TEST_F(BagRecordings, ReportCameraInfoThatIsMissingOrOfAnotherSize) {
  EXPECT_THAT(
      open_error({image_of_bag(kLeft, 1, ms(1000), ms(1001)), image_of_bag(kRight, 2, ms(1000), ms(1001)), infos()[0]}),
      HasSubstr("has no camera info for /right/image_raw"));
  ros::CameraInfo large = info("left");
  large.width = 640;
  EXPECT_THAT(
      open_error({image_of_bag(kLeft, 1, ms(1000), ms(1001)), scene_message("/left/camera_info", ms(1000), large)}),
      HasSubstr("/left/camera_info: is 640x4, but the images are 6x4"));
}

TEST_F(BagRecordings, UseStaticFramesForTheCameraPose) {
  ros::TransformStamped mount{{.frame_id = "base_link"}, "left", {{0.3, 0.1, 0.5}, {0.0, 0.0, 0.0, 1.0}}};
  std::vector<SceneMessage> messages = with_infos(scene_messages());
  messages.push_back(scene_message("/tf_static", ms(900), ros::TFMessage{{mount}}));
  EXPECT_EQ(open(messages)->calibration().body_from_left.translation, Eigen::Vector3d(0.3, 0.1, 0.5));
}

TEST_F(BagRecordings, ReportUnreadableImages) {
  std::vector<SceneMessage> messages = {image_of_bag(kLeft, 1, ms(1000), ms(1001)), infos()[0]};
  ros::Image strange = scene_image(2, ms(1050));
  strange.encoding = "jpeg2000";
  messages.push_back(scene_message(kLeft, ms(1051), strange));
  const auto recording = open(messages);
  EXPECT_FALSE(recording->read(1).has_value());
  EXPECT_THAT(recording->warnings(),
              ElementsAre(HasSubstr("/left/image_raw at 1050000000: has the unsupported encoding")));
}

TEST_F(BagRecordings, ReportDamageOfTheBag) {
  std::vector<SceneMessage> messages = infos();
  for (SceneMessage& each : scene_messages()) messages.push_back(std::move(each));
  BagBytes bytes = mcap_bytes(messages, "-");
  bytes.resize(bytes.size() - 400);
  const auto recording = open_recording(write("cut.mcap", bytes), {}, {.calibration = {}, .left_topic = kLeft});
  EXPECT_THAT(recording->warnings(), testing::Contains(HasSubstr("cut.mcap: is truncated or damaged from byte")));
}

TEST_F(BagRecordings, AcceptTopicsUnlikeOtherRecordings) {
  write("images/a.png", std::string("no image"));
  EXPECT_THAT(error_of([&] { open_recording(folder_ / "images", {}, {.left_topic = kLeft}); }),
              HasSubstr("is not a bag and has no topics"));
  EXPECT_THAT(open_error(with_infos(scene_messages()), {.frame_rate_hz = 20.0}), HasSubstr("has time stamps"));
}

constexpr const char* kDepth = "/depth/image_raw";

// Depths of 6x4 pixels, 16UC1 in millimetres: all the same except for the first, which is invalid.
ros::Image depth_message(Timestamp stamp, std::uint16_t millimetres) {
  ros::Image image{{ros::to_time(stamp), "left"}, 4, 6, "16UC1", 0, 12, std::vector<std::uint8_t>(48)};
  for (std::size_t i = 1; i < 24; ++i) std::memcpy(image.data.data() + 2 * i, &millimetres, 2);
  return image;
}

ros::Image depth_in_metres(Timestamp stamp, float metres) {
  ros::Image image{{ros::to_time(stamp), "left"}, 4, 6, "32FC1", 0, 24, std::vector<std::uint8_t>(96)};
  const float invalid = std::numeric_limits<float>::quiet_NaN();
  for (std::size_t i = 0; i < 24; ++i) std::memcpy(image.data.data() + 4 * i, i == 0 ? &invalid : &metres, 4);
  return image;
}

std::vector<SceneMessage> colour_images() {
  return {image_of_bag(kLeft, 1, ms(1000), ms(1001)), image_of_bag(kLeft, 2, ms(1050), ms(1051)), infos()[0]};
}

std::vector<SceneMessage> with(std::vector<SceneMessage> messages, SceneMessage more) {
  messages.push_back(std::move(more));
  return messages;
}

// The last depth of the first frame, metres.
double depth_of_first(Recording& recording) {
  const auto frame = recording.read(0);
  if (!frame || !frame->depth) return -1.0;
  EXPECT_EQ(frame->depth->units.front(), 0);
  return frame->depth->units.back() / recording.calibration().depth->units_per_metre;
}

TEST_F(BagRecordings, HaveDepthWithoutAnOption) {
  const auto recording = open(with(colour_images(), scene_message(kDepth, ms(1001), depth_message(ms(1004), 1234))));
  EXPECT_THAT(recording->warnings(), IsEmpty());
  ASSERT_TRUE(recording->calibration().depth);
  EXPECT_FALSE(recording->calibration().depth->camera) << "without camera info of its own";
  EXPECT_EQ(camera_of(*recording, {}), CameraChoice::rgbd);
  EXPECT_NEAR(depth_of_first(*recording), 1.234, 1e-9);
  EXPECT_FALSE(recording->read(1)->depth) << "too far in time";
}

TEST_F(BagRecordings, ReadEveryKindOfDepth) {
  EXPECT_NEAR(
      depth_of_first(*open(with(colour_images(), scene_message(kDepth, ms(1001), depth_in_metres(ms(1000), 1.2345f))))),
      1.2345, 1e-4);
  cv::Mat pixels(4, 6, CV_16U, cv::Scalar(1234));
  pixels.at<std::uint16_t>(0, 0) = 0;
  std::vector<std::uint8_t> png;
  cv::imencode(".png", pixels, png);
  const auto message = [&](const std::string& format, std::array<float, 3> head) {
    ros::CompressedImage image{{ros::to_time(ms(1000)), "left"}, format, png};
    if (format.find("compressedDepth") == std::string::npos) return image;
    image.data.insert(image.data.begin(), 12, 0);
    std::memcpy(image.data.data(), head.data(), 12);
    return image;
  };
  const auto depth = [&](const std::string& topic, const ros::CompressedImage& image) {
    return depth_of_first(*open(with(colour_images(), scene_message(topic, ms(1001), image))));
  };
  EXPECT_NEAR(depth("/depth/image_raw/compressedDepth", message("16UC1; compressedDepth png", {})), 1.234, 1e-9);
  EXPECT_NEAR(depth("/depth/image_raw/compressed", message("16UC1; png compressed ", {})), 1.234, 1e-9);
  // Depth = a / (value - b): 2000 / (1234 - 34).
  EXPECT_NEAR(depth("/depth/image/compressedDepth", message("32FC1; compressedDepth png", {0.0f, 2000.0f, 34.0f})),
              2000.0 / 1200.0, 1e-4);
  EXPECT_THAT(open_error(with(colour_images(), scene_message("/depth/image/compressedDepth", ms(1001),
                                                             message("16UC1; compressedDepth rvl", {}))),
                         {.camera = CameraChoice::rgbd}),
              HasSubstr("has depths compressed as RVL"));
}

TEST_F(BagRecordings, PlaceADepthCameraByTheTransformTree) {
  std::vector<SceneMessage> messages =
      with(colour_images(), scene_message(kDepth, ms(1001), depth_message(ms(1000), 1234)));
  ros::CameraInfo own = info("depth");
  own.k[0] = 4.0;
  messages.push_back(scene_message("/depth/camera_info", ms(1000), own));
  const auto ignored = open(messages);
  EXPECT_FALSE(ignored->calibration().depth);
  EXPECT_THAT(ignored->warnings(),
              ElementsAre(testing::AllOf(HasSubstr("has the frame \"depth\", which /tf_static does not connect"),
                                         HasSubstr("depth is ignored"))));
  EXPECT_THAT(open_error(messages, {.camera = CameraChoice::rgbd}), HasSubstr("does not connect to that of the left"));
  const ros::TransformStamped mount{{.frame_id = "left"}, "depth", {{-0.015, 0.0, 0.0}, {0.0, 0.0, 0.0, 1.0}}};
  messages.push_back(scene_message("/tf_static", ms(900), ros::TFMessage{{mount}}));
  const auto recording = open(messages);
  ASSERT_TRUE(recording->calibration().depth && recording->calibration().depth->camera);
  EXPECT_EQ(recording->calibration().depth->camera->fx, 4.0);
  EXPECT_EQ(recording->calibration().depth->left_from_depth.translation.x(), -0.015);
  EXPECT_NEAR(depth_of_first(*recording), 1.234, 1e-9);
}

// Such as depth at half the resolution of colour.
TEST_F(BagRecordings, PlaceDepthOfAnotherSizeByItsCameraInfo) {
  ros::Image half = depth_message(ms(1000), 1234);
  half.width = 3;
  half.height = 2;
  half.step = 6;
  half.data.resize(12);
  ros::CameraInfo own = info("left");
  own.width = 3;
  own.height = 2;
  own.k = {2.5, 0.0, 1.0, 0.0, 2.5, 0.5, 0.0, 0.0, 1.0};
  for (const std::string camera : {"/depth", "/depth_registered"}) {
    std::vector<SceneMessage> messages = with(colour_images(), scene_message(camera + "/image_raw", ms(1001), half));
    messages.push_back(scene_message(camera + "/camera_info", ms(1000), own));
    const auto recording = open(messages);
    EXPECT_THAT(recording->warnings(), IsEmpty());
    ASSERT_TRUE(recording->calibration().depth && recording->calibration().depth->camera) << camera;
    EXPECT_EQ(recording->calibration().depth->camera->fx, 2.5);
    EXPECT_EQ(recording->calibration().depth->left_from_depth.translation.norm(), 0.0);
    EXPECT_NEAR(depth_of_first(*recording), 1.234, 1e-9);
  }
}

TEST_F(BagRecordings, UseTheDepthScaleOfTheCalibrationFile) {
  write(
      "scaled.yaml",
      "camera_matrix: {rows: 3, cols: 3, data: [4.0, 0, 2.5, 0, 4.0, 1.5, 0, 0, 1]}\nimage_width: 6\nimage_height: 4\n"
      "distortion_coefficients: {rows: 1, cols: 5, data: [0, 0, 0, 0, 0]}\ndepth_scale: 5000\n");
  const auto recording = open(with(colour_images(), scene_message(kDepth, ms(1001), depth_message(ms(1000), 10000))),
                              {.calibration = folder_ / "scaled.yaml"});
  EXPECT_NEAR(depth_of_first(*recording), 2.0, 1e-9);
}

TEST_F(BagRecordings, IgnoreTheSignOfTheBaselineWithAWarning) {
  std::vector<SceneMessage> messages = scene_messages();
  messages.push_back(infos()[0]);
  messages.push_back(scene_message("/right/camera_info", ms(1000), info("left", 0.5)));
  const auto recording = open(messages);
  EXPECT_NEAR(recording->calibration().right->right_from_left.translation.x(), -0.1, 1e-12);
  EXPECT_THAT(recording->warnings(), ElementsAre(HasSubstr("/right/camera_info: the baseline in P is positive")));
}

TEST_F(BagRecordings, TakeTheImageSizeWhereTheCalibrationHasNone) {
  write("k.yaml", "K: [4.0, 0, 2.5, 0, 4.0, 1.5, 0, 0, 1]\nD: [0, 0, 0, 0, 0]\n");
  const auto recording = open(colour_images(), {.calibration = folder_ / "k.yaml"});
  EXPECT_EQ(recording->calibration().left.width, 6);
  EXPECT_EQ(recording->calibration().left.height, 4);
}

// Images of 10, 12 and 14 bits in words of 16: half of the largest value is grey 127 or 128.
TEST_F(BagRecordings, DetectTheBitsInUse) {
  for (const int bits : {8, 10, 12, 14, 16}) {
    std::vector<SceneMessage> messages = {infos()[0]};
    for (int i = 0; i < 3; ++i) {
      const auto largest = static_cast<std::uint16_t>((1 << bits) - 1);
      ros::Image image = depth_message(ms(1000 + 50 * i), i == 1 ? largest : static_cast<std::uint16_t>(largest / 2));
      image.encoding = "mono16";
      messages.push_back(scene_message(kLeft, ms(1001 + 50 * i), image));
    }
    const auto recording = open(messages);
    EXPECT_EQ(recording->read(1)->left.pixels.back(), 255) << bits;
    EXPECT_NEAR(recording->read(0)->left.pixels.back(), 127.5, 1.0) << bits;
    EXPECT_EQ(recording->read(0)->left.pixels.front(), 0);
  }
}

TEST_F(BagRecordings, ReadDatabasesOfTheFirstRosbag2) {
  write_db3(folder_ / "old.db3", with_infos(scene_messages()));
  sqlite3* database = nullptr;
  ASSERT_EQ(sqlite3_open((folder_ / "old.db3").c_str(), &database), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(database, "ALTER TABLE topics DROP COLUMN serialization_format", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(database);
  EXPECT_EQ(open_recording(folder_ / "old.db3", {})->read(2)->right->pixels, scene_image(102, {}).data);
}

}  // namespace
}  // namespace byre
