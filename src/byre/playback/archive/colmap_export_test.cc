#include "byre/playback/archive/colmap_export.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/input_error.h"
#include "byre/io/colmap/colmap_camera.h"
#include "byre/playback/archive/colmap_scene.h"

#include <algorithm>

#include <gmock/gmock.h>

namespace byre {
namespace {

class ExportedModel : public testing::Test {
 protected:
  StoredMap stored_ = rendered_map();
  ColmapModel model_ = colmap_model_of(stored_, {});
};

TEST_F(ExportedModel, ContainsTheCameraOfTheImages) {
  ASSERT_EQ(model_.cameras.size(), 1u);
  const Camera& left = stored_.recordings.front().calibration.left;
  const Camera camera = camera_of(model_.cameras.at(1), "camera");
  EXPECT_EQ(camera.model, left.model);
  EXPECT_EQ(camera.distortion, left.distortion);
  EXPECT_EQ(camera.width, left.width);
  EXPECT_DOUBLE_EQ(camera.cx, left.cx);
}

TEST_F(ExportedModel, HasTheCameraPoseOfTheRecording) {
  const Pose& body_from_left = stored_.recordings.front().calibration.body_from_left;
  ASSERT_EQ(model_.images.size(), 8u);
  for (std::uint32_t i = 0; i < 8; ++i) {
    const Pose& world_from_body = RenderedFixture::shared().truth()[3 * i].world_from_body;
    EXPECT_THAT(inverse(model_.images.at(i + 1).camera_from_world),
                PoseNear(world_from_body * body_from_left, 1e-9, 1e-9));
  }
}

TEST_F(ExportedModel, NamesImagesByTheirTimesByDefault) {
  const Timestamp time = RenderedFixture::shared().truth().front().time;
  EXPECT_EQ(model_.images.at(1).name, std::to_string(time.count()) + ".png");
  EXPECT_EQ(colmap_model_of(stored_, {{time, "first.jpg"}}).images.at(1).name, "first.jpg");
  EXPECT_EQ(names_of_images(RenderedFixture::shared().folder()).at(time), model_.images.at(1).name);
  const OpenOptions right{.camera = CameraChoice::right};
  EXPECT_EQ(names_of_images(RenderedFixture::shared().folder(), right).size(),
            RenderedFixture::shared().truth().size());
}

TEST_F(ExportedModel, ContainsThePointsOfTwoViews) {
  for (const PointId id : stored_.map.point_ids()) {
    const auto point = model_.points.find(id.number + 1u);
    const std::size_t views = stored_.map.observations(id).size();
    ASSERT_EQ(point != model_.points.end(), views >= 2);
    if (views < 2) continue;
    EXPECT_EQ(point->second.position_in_world, stored_.map.find_point(id)->position_in_world);
    EXPECT_EQ(point->second.track.size(), views);
  }
}

// Key points of the model are in original images. Those in rectified images differ by tens of pixels.
TEST_F(ExportedModel, ProjectsItsPointsOntoItsKeypoints) {
  const Camera& camera = stored_.recordings.front().calibration.left;
  std::vector<double> errors;
  for (const auto& [id, image] : model_.images) {
    for (const ColmapKeypoint& keypoint : image.keypoints) {
      if (!keypoint.point_id) continue;
      const Eigen::Vector3d& position = model_.points.at(*keypoint.point_id).position_in_world;
      const auto pixel = camera.project(image.camera_from_world * position);
      ASSERT_TRUE(pixel);
      errors.push_back((to_colmap_pixel(*pixel) - keypoint.pixel).norm());
    }
  }
  ASSERT_GT(errors.size(), 500u);
  std::ranges::sort(errors);
  EXPECT_LT(errors[errors.size() / 2], 0.3);
  EXPECT_LT(errors.back(), 10.0);
}

TEST_F(ExportedModel, IsEmptyForAnEmptyMap) {
  const ColmapModel model = colmap_model_of({}, {});
  EXPECT_TRUE(model.images.empty());
  EXPECT_TRUE(model.points.empty());
}

}  // namespace
}  // namespace byre
