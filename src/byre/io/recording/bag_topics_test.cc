#include "byre/io/recording/bag_topics.h"

#include "byre/io/recording/folder_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::HasSubstr;

BagContent bag_of(const std::vector<std::string>& images) {
  BagContent content;
  content.topics.push_back({"/imu", "sensor_msgs/msg/Imu", "cdr", 100});
  for (const std::string& name : images) {
    const bool is_compressed = name.ends_with("/compressed");
    content.topics.push_back(
        {name, is_compressed ? "sensor_msgs/msg/CompressedImage" : "sensor_msgs/msg/Image", "cdr", 7});
  }
  return content;
}

// "left right", or the error.
std::string chosen(const std::vector<std::string>& images, const OpenOptions& options = {}) {
  const BagContent content = bag_of(images);
  std::string names;
  const std::string error = error_of([&] {
    const ImageTopics topics = choose_image_topics(content, options, "walk.bag");
    names = content.topics[topics.left].name;
    if (topics.right) names += " " + content.topics[*topics.right].name;
  });
  return names.empty() ? error : names;
}

TEST(BagTopics, SelectALeftAndRightPair) {
  EXPECT_EQ(chosen({"/right/image_raw", "/left/image_raw"}), "/left/image_raw /right/image_raw");
  EXPECT_EQ(chosen({"/cam0/image_raw", "/cam1/image_raw"}), "/cam0/image_raw /cam1/image_raw");
  EXPECT_EQ(chosen({"/d435/infra1/image_rect_raw", "/d435/infra2/image_rect_raw", "/d435/depth/image_rect_raw"}),
            "/d435/infra1/image_rect_raw /d435/infra2/image_rect_raw");
  EXPECT_EQ(chosen({"/stereo/left/image", "/stereo/right/image", "/rear/image"}),
            "/stereo/left/image /stereo/right/image");
}

// The pairs of ros2/sensors, beside other topics of the same drivers.
TEST(BagTopics, SelectThePairsOfCameraDrivers) {
  EXPECT_EQ(chosen({"/camera/camera/color/image_raw", "/camera/camera/infra1/image_rect_raw",
                    "/camera/camera/infra2/image_rect_raw", "/camera/camera/depth/image_rect_raw"}),
            "/camera/camera/infra1/image_rect_raw /camera/camera/infra2/image_rect_raw");
  EXPECT_EQ(chosen({"/oak/rgb/image_raw", "/oak/stereo/image_raw", "/oak/left/image_rect", "/oak/right/image_rect"}),
            "/oak/left/image_rect /oak/right/image_rect");
  EXPECT_EQ(chosen({"/oakd/rgb/preview/image_raw", "/oakd/left/image_rect", "/oakd/right/image_rect"}),
            "/oakd/left/image_rect /oakd/right/image_rect");
  EXPECT_EQ(chosen({"/zed/zed_node/rgb/color/rect/image", "/zed/zed_node/left/gray/rect/image",
                    "/zed/zed_node/right/gray/rect/image", "/zed/zed_node/depth/depth_registered"}),
            "/zed/zed_node/left/gray/rect/image /zed/zed_node/right/gray/rect/image");
  EXPECT_EQ(camera_info_topic("/zed/zed_node/left/gray/rect/image"), "/zed/zed_node/left/gray/rect/camera_info");
}

TEST(BagTopics, PreferRawAndUnrectifiedImages) {
  EXPECT_EQ(
      chosen({"/left/image_raw/compressed", "/right/image_raw/compressed", "/left/image_raw", "/right/image_raw"}),
      "/left/image_raw /right/image_raw");
  EXPECT_EQ(chosen({"/left/image_rect_color", "/right/image_rect_color", "/left/image_rect", "/right/image_rect"}),
            "/left/image_rect /right/image_rect");
  EXPECT_EQ(chosen({"/camera/image_color", "/camera/image_raw"}), "/camera/image_raw");
}

TEST(BagTopics, AcceptCompressedImagesAlone) {
  EXPECT_EQ(chosen({"/left/image_raw/compressed", "/right/image_raw/compressed"}),
            "/left/image_raw/compressed /right/image_raw/compressed");
}

TEST(BagTopics, SelectTheOnlyCamera) {
  EXPECT_EQ(chosen({"/camera/image_raw"}), "/camera/image_raw");
}

TEST(BagTopics, RequireAChoiceAmongSeveralCameras) {
  const std::string front_and_rear = chosen({"/front/image", "/rear/image"});
  EXPECT_THAT(front_and_rear, HasSubstr("walk.bag: contains images of several cameras"));
  EXPECT_THAT(front_and_rear, HasSubstr("/front/image (7), /rear/image (7)"));
  EXPECT_THAT(front_and_rear, HasSubstr("--left TOPIC"));
  EXPECT_THAT(chosen({"/front/left/image", "/front/right/image", "/rear/left/image", "/rear/right/image"}),
              HasSubstr("several cameras"));
  EXPECT_THAT(chosen({}), HasSubstr("contains no images of a supported type; available image topics: none"));
}

TEST(BagTopics, SelectTheGivenTopics) {
  const std::vector<std::string> images = {"/front/image", "/rear/image", "/rig/left/image", "/rig/right/image"};
  EXPECT_EQ(chosen(images, {.left_topic = "/rear/image"}), "/rear/image");
  EXPECT_EQ(chosen(images, {.left_topic = "front/image", .right_topic = "/rear/image"}), "/front/image /rear/image");
  EXPECT_EQ(chosen(images, {.left_topic = "/rig/left/image"}), "/rig/left/image /rig/right/image");
  EXPECT_THAT(chosen(images, {.left_topic = "/imu"}), HasSubstr("has no images on topic /imu; available image topics"));
  EXPECT_THAT(chosen(images, {.right_topic = "/rear/image"}), HasSubstr("without that of the left camera"));
}

TEST(BagTopics, PreferRawImagesByTypeOfTheTopic) {
  BagContent content;
  content.topics = {{"/left/image_raw", "sensor_msgs/msg/CompressedImage", "cdr", 7},
                    {"/left/image_mono", "sensor_msgs/msg/Image", "cdr", 7}};
  EXPECT_EQ(choose_image_topics(content, {}, "walk.bag").left, 0u) << "less processed";
  content.topics = {{"/left/image", "sensor_msgs/msg/CompressedImage", "cdr", 7},
                    {"/left/image_raw", "sensor_msgs/msg/Image", "cdr", 7}};
  EXPECT_EQ(choose_image_topics(content, {}, "walk.bag").left, 1u) << "raw";
}

TEST(BagTopics, DistinguishCamerasAtTheTopLevel) {
  EXPECT_THAT(chosen({"/front", "/rear"}), HasSubstr("several cameras"));
  EXPECT_EQ(chosen({"/front", "/front/compressed"}), "/front");
  EXPECT_EQ(chosen({"/image_color", "/image_raw"}), "/image_raw");
  EXPECT_EQ(chosen({"/left", "/right"}), "/left /right");
}

TEST(BagTopics, NameVideosThatAreNotRead) {
  BagContent content;
  content.topics = {{"/cam/video", "foxglove_msgs/msg/CompressedVideo", "cdr", 7}};
  EXPECT_THAT(error_of([&] { choose_image_topics(content, {}, "walk.bag"); }),
              testing::AllOf(HasSubstr("walk.bag: has images as video (H.264 or H.265) on topic /cam/video"),
                             HasSubstr("republish it")));
}

std::string chosen_depth(const std::vector<std::string>& images, const OpenOptions& options = {}) {
  const BagContent content = bag_of(images);
  const ImageTopics topics = choose_image_topics(content, options, "walk.bag");
  return topics.depth ? content.topics[*topics.depth].name : "none";
}

TEST(BagTopics, SelectTheDepthOfTheCamera) {
  EXPECT_EQ(chosen_depth({"/camera/rgb/image_color", "/camera/depth/image"}), "/camera/depth/image");
  EXPECT_EQ(chosen_depth({"/a/color/image_raw", "/b/depth/image_raw", "/a/depth/image_raw",
                          "/a/aligned_depth_to_color/image_raw"}),
            "/a/aligned_depth_to_color/image_raw");
  EXPECT_EQ(chosen_depth({"/left/image", "/right/image", "/depth/image"}), "none") << "the pair is used";
  EXPECT_EQ(chosen_depth({"/left/image", "/right/image", "/depth/image"}, {.camera = CameraChoice::rgbd}),
            "/depth/image");
  EXPECT_EQ(chosen_depth({"/color/image", "/depth/image"}, {.camera = CameraChoice::left}), "none");
  EXPECT_EQ(chosen_depth({"/color/image", "/depth/image", "/other/depth"}, {.depth_topic = "/other/depth"}),
            "/other/depth");
  EXPECT_THAT(error_of([] { chosen_depth({"/color/image"}, {.depth_topic = "/depth"}); }),
              HasSubstr("has no depth images on topic /depth"));
}

TEST(BagTopics, FindTheirCameraInfo) {
  EXPECT_EQ(camera_info_topic("/cam0/image_raw"), "/cam0/camera_info");
  EXPECT_EQ(camera_info_topic("/cam0/image_raw/compressed"), "/cam0/camera_info");
  EXPECT_EQ(camera_info_topic("/depth/image_raw/compressedDepth"), "/depth/camera_info");
  EXPECT_EQ(camera_info_topic("image"), "/camera_info");
}

TEST(BagTopics, DetectRectifiedImages) {
  EXPECT_TRUE(is_rectified({"/left/image_rect", "", ""}));
  EXPECT_TRUE(is_rectified({"/left/image_rect_color/compressed", "", ""}));
  EXPECT_FALSE(is_rectified({"/direct/image_raw", "", ""}));
}

}  // namespace
}  // namespace byre
