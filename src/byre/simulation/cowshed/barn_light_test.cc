#include "byre/simulation/cowshed/barn_light.h"

#include "byre/simulation/cowshed/lit_mesh.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector3f;

// A floor 4 m wide, vertices every 0.5 m, and a wall at x = 0.
QuadMesh floor_with_wall() {
  QuadMesh mesh;
  add_panel(mesh, {-2.0f, -2.0f, 0.0f}, {4.0f, 0.0f, 0.0f}, {0.0f, 4.0f, 0.0f}, {});
  add_box(mesh, make_isometry({0.0f, 0.0f, 1.0f}), {0.05f, 2.0f, 1.0f}, {});
  return mesh;
}

BarnLight lamp_on_the_right() {
  return {.windows = {}, .lamps = {{{1.0f, 0.0f, 1.0f}, 2.0f}}, .ambient = 0.1f};
}

float light_on_floor(const QuadMesh& mesh, const std::vector<float>& light, const Vector3f& point) {
  for (std::size_t i = 0; i < light.size(); ++i) {
    if ((mesh.vertices[i] - point).norm() < 1e-4f && mesh.normals[i].z() > 0.9f) return light[i];
  }
  ADD_FAILURE() << "no vertex at " << point.transpose();
  return 0.0f;
}

TEST(BarnLight, DecreasesWithDistanceAndDoesNotPassWalls) {
  const QuadMesh mesh = floor_with_wall();
  const std::vector<float> light = light_at_vertices(mesh, RayScene(mesh, 0), lamp_on_the_right(), 1);
  EXPECT_NEAR(light_on_floor(mesh, light, {1.0f, 0.0f, 0.0f}), 2.0f + 0.1f, 0.12f);  // 1 m under the lamp
  EXPECT_LT(light_on_floor(mesh, light, {1.0f, 1.5f, 0.0f}), 1.0f);
  EXPECT_LE(light_on_floor(mesh, light, {-1.0f, 0.0f, 0.0f}), 0.1f);
}

TEST(BarnLight, IsWeakerInCorners) {
  const QuadMesh mesh = floor_with_wall();
  const std::vector<float> light = light_at_vertices(mesh, RayScene(mesh, 0), {.ambient = 1.0f}, 1);
  EXPECT_LT(light_on_floor(mesh, light, {-0.5f, 0.0f, 0.0f}), light_on_floor(mesh, light, {-2.0f, 0.0f, 0.0f}));
}

TEST(BarnLight, ShinesOnlyFromTheFrontOfWindows) {
  QuadMesh mesh;
  add_panel(mesh, {-1.0f, -1.0f, 0.0f}, {2.0f, 0.0f, 0.0f}, {0.0f, 2.0f, 0.0f}, {});
  BarnLight light;
  light.windows.push_back({{0.0f, 0.0f, 3.0f}, {0.5f, 0.0f, 0.0f}, {0.0f, 0.5f, 0.0f}, {0.0f, 0.0f, -1.0f}, 4.0f});
  const RayScene rays(mesh, 0);
  // One square metre of radiance 4, 3 m away: 4 * 1 / (pi * 9).
  EXPECT_NEAR(light_on_floor(mesh, light_at_vertices(mesh, rays, light, 1), Vector3f::Zero()), 0.14f, 0.01f);
  light.windows.front().normal.z() = 1.0f;
  EXPECT_EQ(light_on_floor(mesh, light_at_vertices(mesh, rays, light, 1), Vector3f::Zero()), 0.0f);
}

TEST(BarnLight, IsIndependentOfTheNumberOfThreads) {
  const QuadMesh mesh = floor_with_wall();
  const RayScene rays(mesh, 0);
  EXPECT_EQ(light_at_vertices(mesh, rays, lamp_on_the_right(), 1),
            light_at_vertices(mesh, rays, lamp_on_the_right(), 3));
}

TEST(LitMesh, MapsItsPictureToEachFacet) {
  QuadMesh mesh;
  const Vector3f right = Vector3f(1.0f, 2.0f, 0.5f).normalized();
  const Vector3f up = right.cross(Vector3f(0.3f, -0.2f, 1.0f)).normalized();
  add_panel(mesh, {1.0f, 1.0f, 1.0f}, 2.0f * right, up, {.texture_width = 0.5f});
  const LitMesh lit(mesh, std::vector<float>(mesh.vertices.size(), 0.7f), 0);
  for (unsigned i = 0; i < mesh.quads.size(); ++i) {
    EXPECT_LT((lit.facet(i).u_slope - 2.0f * right).norm(), 1e-4f);
    EXPECT_LT((lit.facet(i).v_slope - 2.0f * up).norm(), 1e-4f);
    EXPECT_LT((lit.facet(i).normal - right.cross(up)).norm(), 1e-4f);
  }
  EXPECT_FLOAT_EQ(lit.mean_light(), 0.7f);
}

}  // namespace
}  // namespace byre
