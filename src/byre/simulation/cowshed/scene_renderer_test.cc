#include "byre/simulation/cowshed/scene_renderer.h"

#include "byre/simulation/cowshed/feeding_robot.h"

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

Material glowing(float radiance) {
  Material material;
  material.glow = radiance;
  return material;
}

// View of a camera at the origin along z: a wall, and before it a marker from (-0.5, -0.3) to (0.3, 0.4) metres.
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
    return SceneRenderer(still, textures, air, threads).radiance({pixels, {}}, nothing, instant);
  }

  // Sub-pixel position along a row of the step between wall and marker radiance.
  static double rise(const std::vector<float>& row, int from, int to) {
    double covered = 0.0;
    for (int i = from; i <= to; ++i) covered += (row[static_cast<std::size_t>(i)] - kWall) / (kMarker - kWall);
    return to + 0.5 - covered;
  }

  const Camera camera = feeding_robot_calibration(2).left;
  const PixelRays pixels{camera};
  const BarnTextures textures{kBarnTextures, MipTexture(1, {0.5f})};  // no surface here shows a texture
  const LitMesh still = unlit(wall_and_marker(), 0);
  const LitMesh nothing = unlit({}, 1);
};

TEST_F(RenderedMarker, EndsAtItsEdgesProjectedThroughTheLens) {
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
  const std::vector<float> depths = SceneRenderer(still, textures, {}, 1).depths({pixels, {}}, nothing);
  const auto at = [&](const Vector3d& point) {
    const Vector2d pixel = camera.project(point).value();
    return depths[static_cast<std::size_t>(std::lround(pixel.y()) * camera.width + std::lround(pixel.x()))];
  };
  EXPECT_NEAR(at({-0.1, 0.1, kMarkerDepth}), kMarkerDepth, 1e-4);
  EXPECT_NEAR(at({1.5, -0.7, kWallDepth}), kWallDepth, 1e-4);
}

TEST_F(RenderedMarker, IsIndependentOfTheNumberOfThreads) {
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

TEST_F(RenderedMarker, IsDarkerInDimLight) {
  const SceneView half{pixels, {}, {.share = 0.5f}};
  const std::vector<float> radiance = SceneRenderer(still, textures, {}, 1).radiance(half, nothing, {});
  const std::vector<float> full = render({});
  for (std::size_t i = 0; i < full.size(); ++i) ASSERT_FLOAT_EQ(radiance[i], 0.5f * full[i]) << i;
}

// Radiance of a wall at a distance straight ahead.
TEST_F(RenderedMarker, IsLitByAHeadlightWithInverseSquareFalloff) {
  const auto middle_of_wall = [this](float distance) {
    QuadMesh wall;
    add_panel(wall, {-20.0f, 20.0f, distance}, {40.0f, 0.0f, 0.0f}, {0.0f, -40.0f, 0.0f}, {}, 10.0f);
    const LitMesh unlit_wall(wall, std::vector<float>(wall.vertices.size(), 0.0f), 0);
    const SceneView view{pixels, {}, {.headlight = 2.0f}};
    const Vector2d pixel = camera.project({0.0, 0.0, distance}).value();
    return SceneRenderer(unlit_wall, textures, {}, 1)
        .radiance(view, nothing,
                  {})[static_cast<std::size_t>(std::lround(pixel.y()) * camera.width + std::lround(pixel.x()))];
  };
  EXPECT_GT(middle_of_wall(2.0f), 0.0f);
  EXPECT_NEAR(middle_of_wall(4.0f), middle_of_wall(2.0f) / 4.0f, 1e-3f * middle_of_wall(2.0f));
}

TEST_F(RenderedMarker, IsOccludedByMovingObjects) {
  QuadMesh curtain;
  add_panel(curtain, {-9.0f, 9.0f, 1.0f}, {18.0f, 0.0f, 0.0f}, {0.0f, -18.0f, 0.0f}, glowing(2.0f), 20.0f);
  const LitMesh moving = unlit(curtain, 1);
  EXPECT_THAT(SceneRenderer(still, textures, {}, 1).radiance({pixels, {}}, moving, {}), Each(FloatEq(2.0f)));
}

// Row poses decide, not their times: the first row looks from the start of the motion, the last one from its end.
TEST_F(RenderedMarker, IsRenderedPerRowFromTheMovingCamera) {
  const auto camera_at = [&](int row) {
    return Pose{Eigen::Quaterniond::Identity(), {0.4 * row / (camera.height - 1.0), 0.0, 0.0}};
  };
  SceneView view{pixels, {}};
  for (int row = 0; row < camera.height; ++row) view.world_from_camera_by_row.push_back(camera_at(row));
  const SceneRenderer renderer(still, textures, {}, 1);
  const std::vector<float> radiance = renderer.radiance(view, nothing, {});
  double above = 0.0, below = 0.0;
  for (const int row : {camera.height / 2 - 25, camera.height / 2 + 25}) {
    const auto begin = radiance.begin() + static_cast<std::ptrdiff_t>(row) * camera.width;
    const std::vector<float> line(begin, begin + camera.width);
    double u = 0.5 * camera.width;  // column of the marker's left edge, which lens distortion bends along the row
    for (int round = 0; round < 4; ++round) {
      const double v_of_edge = camera.bearing({u, static_cast<double>(row)}).value().y();
      const double z_of_edge = camera.bearing({u, static_cast<double>(row)}).value().z();
      const Vector3d edge(-0.5, v_of_edge / z_of_edge * kMarkerDepth, kMarkerDepth);
      u = camera.project(inverse(camera_at(row)) * edge).value().x();
    }
    const int edge = static_cast<int>(std::lround(u));
    (row < camera.height / 2 ? above : below) = rise(line, edge - 4, edge + 4);
    EXPECT_NEAR(rise(line, edge - 4, edge + 4), u, 0.3);
  }
  EXPECT_GT(above - below, 5.0);
}

TEST_F(RenderedMarker, ShowsMovingObjectsPerRow) {
  QuadMesh begin, end;
  add_panel(begin, {-2.0f, 9.0f, 1.0f}, {2.0f, 0.0f, 0.0f}, {0.0f, -18.0f, 0.0f}, glowing(2.0f), 20.0f);
  add_panel(end, {-1.5f, 9.0f, 1.0f}, {2.0f, 0.0f, 0.0f}, {0.0f, -18.0f, 0.0f}, glowing(2.0f), 20.0f);
  const std::vector<float> light(begin.vertices.size(), 1.0f);
  const LitMesh moving(begin, end, light, 1, RayScene::Build::quick);
  const SceneView view{pixels, {}, {}, std::vector<Pose>(static_cast<std::size_t>(camera.height))};
  const std::vector<float> depths = SceneRenderer(still, textures, {}, 1).depths(view, moving);
  for (int row = 0; row < camera.height; row += 30) {
    const double edge = 0.5 * row / (camera.height - 1.0);  // right end of the panel
    for (int column = 0; column < camera.width; ++column) {
      const Vector3d ray = camera.bearing({static_cast<double>(column), static_cast<double>(row)}).value();
      const double x = ray.x() / ray.z();  // intersection with the panel's plane
      if (x < -1.4 || std::abs(x - edge) < 0.01) continue;
      const auto i = static_cast<std::size_t>(row * camera.width + column);
      EXPECT_EQ(depths[i] < 1.5f, x < edge) << "row " << row << ", column " << column;
    }
  }
}

TEST(RayScene, DetectsAWallBetweenTwoPoints) {
  const RayScene rays(wall_and_marker(), 0);
  EXPECT_TRUE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 1.9f}));
  EXPECT_FALSE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, 2.1f}));
  EXPECT_TRUE(rays.is_free({0.0f, 0.0f, 0.0f}, {0.0f, 0.0f, kMarkerDepth}));  // the marker's surface
  EXPECT_TRUE(rays.is_free({2.0f, 0.0f, 0.0f}, {2.0f, 0.0f, 3.9f}));
}

}  // namespace
}  // namespace byre
