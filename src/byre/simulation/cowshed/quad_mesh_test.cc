#include "byre/simulation/cowshed/quad_mesh.h"

#include <gmock/gmock.h>

namespace byre {
namespace {

using Eigen::Vector3f;

const Material kMaterial{.texture_width = 0.5f};

// Normal from a facet's corners, counter-clockwise.
Vector3f facet_normal(const QuadMesh& mesh, std::size_t quad) {
  const auto& corners = mesh.quads[quad];
  return (mesh.vertices[corners[2]] - mesh.vertices[corners[0]])
      .cross(mesh.vertices[corners[3]] - mesh.vertices[corners[1]])
      .normalized();
}

void expect_to_face_away_from(const QuadMesh& mesh, const Vector3f& inside) {
  ASSERT_FALSE(mesh.quads.empty());
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    const Vector3f& corner = mesh.vertices[mesh.quads[i].front()];
    EXPECT_GT(facet_normal(mesh, i).dot(corner - inside), 0.0f) << "facet " << i;
  }
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(mesh.normals[i].norm(), 1.0f, 1e-5f);
    EXPECT_GT(mesh.normals[i].dot(mesh.vertices[i] - inside), 0.0f) << "vertex " << i;
  }
}

TEST(QuadMesh, ShowsTheOutsideOfABox) {
  QuadMesh mesh;
  add_box(mesh, make_isometry({1.0f, 2.0f, 3.0f}, 0.7f), {0.5f, 0.3f, 0.2f}, kMaterial);
  expect_to_face_away_from(mesh, {1.0f, 2.0f, 3.0f});
  EXPECT_EQ(mesh.surfaces.size(), 6u);
}

TEST(QuadMesh, ShowsTheOutsideOfADrum) {
  QuadMesh mesh;
  add_drum(mesh, {0.0f, 0.0f, 0.0f}, {0.2f, 0.1f, 1.0f}, 0.3f, 0.2f, kMaterial);
  expect_to_face_away_from(mesh, {0.1f, 0.05f, 0.5f});
}

TEST(QuadMesh, ShowsTheOutsideOfAnEllipsoid) {
  QuadMesh mesh;
  add_ellipsoid(mesh, make_isometry({0.0f, 1.0f, 0.0f}), {0.5f, 0.3f, 0.2f}, kMaterial);
  expect_to_face_away_from(mesh, {0.0f, 1.0f, 0.0f});
}

TEST(QuadMesh, HasABarOfTheGivenWidth) {
  QuadMesh mesh;
  add_bar(mesh, {0.0f, 0.0f, 1.0f}, {2.0f, 0.0f, 1.0f}, 0.1f, kMaterial);
  for (const Vector3f& vertex : mesh.vertices) {
    EXPECT_NEAR((vertex - Vector3f(vertex.x(), 0.0f, 1.0f)).norm(), 0.1f, 1e-5f);
  }
}

TEST(QuadMesh, MapsPicturesToTheirWidth) {
  QuadMesh mesh;
  add_panel(mesh, Vector3f::Zero(), {2.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, kMaterial);
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    EXPECT_NEAR(mesh.texture_coordinates[i].x(), mesh.vertices[i].x() / kMaterial.texture_width, 1e-5f);
    EXPECT_NEAR(mesh.texture_coordinates[i].y(), mesh.vertices[i].y() / kMaterial.texture_width, 1e-5f);
  }
}

TEST(QuadMesh, LimitsTheSizeOfFacets) {
  QuadMesh mesh;
  add_panel(mesh, Vector3f::Zero(), {2.0f, 0.0f, 0.0f}, {0.0f, 0.9f, 0.0f}, kMaterial, 0.25f);
  EXPECT_EQ(mesh.quads.size(), 8u * 4u);
}

}  // namespace
}  // namespace byre
