#include "byre/extrinsics_file.h"
#include "byre/geometry/geometry_matchers.h"
#include "byre/io/bag/bag_scene.h"
#include "byre/io/recording/folder_scene.h"

#include <limits>

#include <gmock/gmock.h>

namespace byre {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr Timestamp kTime = std::chrono::milliseconds(1000);

SceneMessage fixed(const std::string& parent, const std::string& child, const Pose& parent_from_child) {
  const Eigen::Vector3d& t = parent_from_child.translation;
  const Eigen::Quaterniond& q = parent_from_child.rotation;
  return scene_message(
      "/tf_static", kTime,
      ros::TFMessage{{{{.frame_id = parent}, child, {{t.x(), t.y(), t.z()}, {q.x(), q.y(), q.z(), q.w()}}}}});
}

Pose camera_ahead(double height) {
  return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.4, 0.1, height}};
}

SceneMessage image(const std::string& topic, const std::string& frame) {
  ros::Image image = scene_image(1, kTime);
  image.header.frame_id = frame;
  return scene_message(topic, kTime, image);
}

SceneMessage imu(const std::string& topic, const std::string& frame) {
  return scene_message(topic, kTime, ros::Imu{.header = {.frame_id = frame}});
}

std::vector<SceneMessage> tree() {
  return {fixed("base_link", "a_optical_frame", camera_ahead(1.0)), fixed("base_link", "b", camera_ahead(2.0)),
          fixed("/b", "/c", {rotation_exp({0, 0, 0.3}), {0, 0, 0.5}}),
          fixed("base_link", "imu_link", {rotation_exp({0.1, 0.2, 0.3}), {0, 0.2, 0}})};
}

class BagExtrinsics : public BagFolderTest {
 protected:
  Extrinsics read(std::vector<SceneMessage> messages, const std::vector<SceneMessage>& more = {},
                  const ExtrinsicsFrames& frames = {}) const {
    messages.insert(messages.end(), more.begin(), more.end());
    return read_extrinsics(write("walk.mcap", mcap_bytes(messages, "zstd")), frames);
  }
  std::string read_error(const std::vector<SceneMessage>& messages, const std::vector<SceneMessage>& more = {},
                         const ExtrinsicsFrames& frames = {}) const {
    return error_of([&] { read(messages, more, frames); });
  }
};

TEST_F(BagExtrinsics, AreEqualInEveryBagFormat) {
  write_db3(folder_ / "walk.db3", tree());
  for (const auto& path :
       {folder_ / "walk.db3", write("walk.bag", ros1_bytes(tree())), write("walk.mcap", mcap_bytes(tree(), "-"))}) {
    const Extrinsics extrinsics = read_extrinsics(path);
    ASSERT_TRUE(extrinsics.camera && extrinsics.imu) << path;
    EXPECT_THAT(extrinsics.camera->base_from_sensor, PoseNear(camera_ahead(1.0), 1e-12, 1e-7));
    EXPECT_THAT(extrinsics.imu->base_from_sensor,
                PoseNear(Pose{rotation_exp({0.1, 0.2, 0.3}), {0, 0.2, 0}}, 1e-12, 1e-7));
  }
}

TEST_F(BagExtrinsics, TakeTheFramesOfImagesAndImu) {
  const Extrinsics extrinsics =
      read(tree(), {image("/left/image_raw", "/b"), image("/right/image_raw", "a_optical_frame"), imu("/imu", "c")});
  EXPECT_THAT(extrinsics.camera->base_from_sensor, PoseNear(camera_ahead(2.0), 1e-12, 1e-7));
  EXPECT_THAT(extrinsics.imu->base_from_sensor,
              PoseNear(camera_ahead(2.0) * Pose{rotation_exp({0, 0, 0.3}), {0, 0, 0.5}}, 1e-12, 1e-7));
  EXPECT_FALSE(read(tree(), {imu("/imu", "chip")}).imu) << "its frame is unknown";
  EXPECT_TRUE(read(tree(), {imu("/imu", "chip"), imu("/imu_2", "c")}).imu) << "imu_link by convention";
  const Extrinsics named = read(tree(), {image("/left/image_raw", "b")}, {.camera = "a_optical_frame"});
  EXPECT_THAT(named.camera->base_from_sensor, PoseNear(camera_ahead(1.0), 1e-12, 1e-7));
}

TEST_F(BagExtrinsics, RejectUnknownFramesOfImages) {
  EXPECT_THAT(read_error(tree(), {image("/left/image_raw", "cam0")}),
              AllOf(HasSubstr("walk.mcap: /tf_static: has no frame \"cam0\", which the left images name"),
                    HasSubstr("a_optical_frame")));
  EXPECT_THAT(read_error({image("/left/image_raw", "cam0")}), HasSubstr("has no transforms on /tf_static"));
}

TEST_F(BagExtrinsics, RejectInvalidTransforms) {
  Pose turned = camera_ahead(1.0);
  turned.rotation.coeffs() *= 1.005;
  EXPECT_THAT(read_error({fixed("base_link", "a_optical_frame", turned)}),
              HasSubstr("walk.mcap: /tf_static: a_optical_frame: is no finite translation and unit quaternion"));
  const Pose infinite{{1, 0, 0, 0}, {std::numeric_limits<double>::infinity(), 0, 0}};
  EXPECT_THAT(read_error({fixed("base_link", "a_optical_frame", infinite)}), HasSubstr("is no finite translation"));
  EXPECT_TRUE(read(tree(), {fixed("base_link", "wheel", infinite)}).camera) << "not between base and sensors";
  EXPECT_THAT(read_error(tree(), {fixed("c", "b", {})}), HasSubstr("has a cycle of transforms"));
  EXPECT_THAT(read_error({fixed("base_link", "front", {}), fixed("front", "camera_link", {})},
                         {image("/left/image_raw", "camera_link")}),
              HasSubstr("camera_optical_frame instead of camera_link"));
}

}  // namespace
}  // namespace byre
