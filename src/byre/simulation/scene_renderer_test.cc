#include "byre/simulation/scene_renderer.h"

#include "byre/simulation/feeding_robot.h"

#include <cmath>
#include <optional>

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using ::testing::Each;
using ::testing::FloatEq;

constexpr float kWall = 1.0f;    // radiance
constexpr float kMarker = 3.0f;  // radiance
constexpr float kMarkerDepth = 2.0f;
constexpr float kWallDepth = 4.0f;

SurfaceLook glowing(float radiance) {
  SurfaceLook look;
  look.glow = radiance;
  return look;
}

// Seen by a camera at the origin that looks along z: a wall, and before it a marker from -0.5, -0.3 to 0.3, 0.4.
QuadMesh wall_and_marker() {
  QuadMesh mesh;
  add_panel(mesh, {-20.0f, 20.0f, kWallDepth}, {40.0f, 0.0f, 0.0f}, {0.0f, -40.0f, 0.0f}, glowing(kWall), 10.0f);
  add_panel(mesh, {-0.5f, 0.4f, kMarkerDepth}, {0.8f, 0.0f, 0.0f}, {0.0f, -0.7f, 0.0f}, glowing(kMarker));
  return mesh;
}

LitMesh unlit(const QuadMesh& mesh, unsigned id) {
  return {mesh, std::vector<float>(mesh.vertices.size(), 1.0f), id};
}

class RenderedMarker : public ::testing::Test {
 protected:
  std::vector<float> render(const ExposureInstant& instant, const Air& air = {}, int threads = 1) const {
    return SceneRenderer(still, pictures, air, threads).radiance({pixels, {}}, nothing, instant);
  }

  // Where along a row the radiance rises to the marker's, or falls from it: between pixels, by their share.
  static double rise(const std::vector<float>& row, int from, int to) {
    double covered = 0.0;
    for (int i = from; i <= to; ++i) covered += (row[static_cast<std::size_t>(i)] - kWall) / (kMarker - kWall);
    return to + 0.5 - covered;
  }

  const Camera camera = feeding_robot_calibration(2).left;
  const PixelRays pixels{camera};
  const BarnPictures pictures{kBarnPictures, MipTexture(1, {0.5f})};  // nothing here shows one
  const LitMesh still = unlit(wall_and_marker(), 0);
  const LitMesh nothing = unlit({}, 1);
};

TEST_F(RenderedMarker, EndsWhereItsEdgesAreProjectedThroughTheLens) {
  const std::vector<float> radiance = render({});
  for (const double y : {-0.2, 0.05, 0.3}) {
    const std::optional<Vector2d> left = camera.project({-0.5, y, kMarkerDepth});
    const std::optional<Vector2d> right = camera.project({0.3, y, kMarkerDepth});
    ASSERT_TRUE(left && right);
    const auto row = static_cast<std::ptrdiff_t>(std::lround(left->y())) * camera.width;
    const std::vector<float> line(radiance.begin() + row, radiance.begin() + row + camera.width);
    const int edge = static_cast<int>(std::lround(left->x()));
    EXPECT_NEAR(rise(line, edge - 4, edge + 4), left->x(), 0.3);
    EXPECT_FLOAT_EQ(line[static_cast<std::size_t>(std::lround(right->x()) - 2)], kMarker);
    EXPECT_FLOAT_EQ(line[static_cast<std::size_t>(std::lround(right->x()) + 2)], kWall);
  }
}

TEST_F(RenderedMarker, HasTheDepthAlongTheOpticalAxis) {
  const std::vector<float> depths = SceneRenderer(still, pictures, {}, 1).depths({pixels, {}}, nothing);
  const auto at = [&](const Vector3d& point) {
    const Vector2d pixel = camera.project(point).value();
    return depths[static_cast<std::size_t>(std::lround(pixel.y()) * camera.width + std::lround(pixel.x()))];
  };
  EXPECT_NEAR(at({-0.1, 0.1, kMarkerDepth}), kMarkerDepth, 1e-4);
  EXPECT_NEAR(at({1.5, -0.7, kWallDepth}), kWallDepth, 1e-4);
}

TEST_F(RenderedMarker, IsTheSameWithAnyNumberOfThreads) {
  EXPECT_EQ(render({}, {}, 1), render({}, {}, 5));
}

TEST_F(RenderedMarker, FadesInDust) {
  const Air dusty{.haze = 0.1f, .glow = 0.5f};
  const std::vector<float> radiance = render({}, dusty);
  const Vector2d pixel = camera.project({0.0, 0.0, kMarkerDepth}).value();
  const float clear = std::exp(-0.1f * kMarkerDepth);
  EXPECT_NEAR(radiance[static_cast<std::size_t>(std::lround(pixel.y()) * camera.width + std::lround(pixel.x()))],
              0.5f + clear * (kMarker - 0.5f), 1e-3f);
}

TEST_F(RenderedMarker, IsHiddenByWhatMovesBeforeIt) {
  QuadMesh curtain;
  add_panel(curtain, {-9.0f, 9.0f, 1.0f}, {18.0f, 0.0f, 0.0f}, {0.0f, -18.0f, 0.0f}, glowing(2.0f), 20.0f);
  const LitMesh moving = unlit(curtain, 1);
  EXPECT_THAT(SceneRenderer(still, pictures, {}, 1).radiance({pixels, {}}, moving, {}), Each(FloatEq(2.0f)));
}

TEST(RayScene, TellsWhetherAWallIsBetweenTwoPoints) {
  const RayScene rays(wall_and_marker(), 0);
  EXPECT_TRUE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.9f}));
  EXPECT_FALSE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 2.1f}));
  EXPECT_TRUE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, kMarkerDepth}));  // the marker itself
  EXPECT_TRUE(rays.is_free({2.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 3.9f}));
}

}  // namespace
}  // namespace byre
