#include "byre/simulation/pixel_rays.h"

#include "byre/geometry/geometry_matchers.h"
#include "byre/simulation/rendered_room_scene.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

TEST(PixelRays, ProjectToTheirPixelsDespiteDistortion) {
  const Camera camera = euroc_like_calibration(4).left;
  const PixelRays rays(camera);
  for (int row = 0; row < camera.height; row += 17) {
    for (int column = 0; column < camera.width; column += 17) {
      const auto corners = rays.corners(column, row);
      ASSERT_TRUE(corners);
      const auto pixel = camera.project(corners->at(0.5f, 0.5f).cast<double>());
      ASSERT_TRUE(pixel);
      EXPECT_THAT(*pixel, PointNear(Eigen::Vector2d(column, row), 0.01));
    }
  }
}

TEST(PixelRays, AreEmptyOutsideTheFieldOfView) {
  Camera camera{.width = 200, .height = 200, .fx = 40.0, .fy = 40.0, .cx = 99.5, .cy = 99.5, .distortion = {}};
  camera.model = CameraModel::equidistant;  // half sphere: radius 63 pixels around the centre
  const PixelRays rays(camera);
  EXPECT_TRUE(rays.corners(99, 99));
  EXPECT_TRUE(rays.corners(99, 160));
  EXPECT_FALSE(rays.corners(99, 164));
  EXPECT_FALSE(rays.corners(0, 0));
}

}  // namespace
}  // namespace byre
