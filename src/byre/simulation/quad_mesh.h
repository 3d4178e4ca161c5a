#pragma once

#include "byre/simulation/barn_pictures.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace byre {

// What a surface looks like.
struct SurfaceLook {
  BarnPicture picture = BarnPicture::concrete;
  float brightness = 1.0f;                     // times the picture's reflectance
  float picture_width = 2.0f;                  // metres that the picture covers before it repeats
  Eigen::Vector2f picture_offset{0.0f, 0.0f};  // offset in the picture, in pictures
  float glow = 0.0f;                           // radiance; a surface that glows shows neither picture nor light
};

// Surfaces made of four-sided facets, in the world frame, metres.
struct QuadMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;             // normal of each vertex, of unit length, away from the solid
  std::vector<Eigen::Vector2f> picture_places;      // place of each vertex in its picture, in pictures
  std::vector<std::array<std::uint32_t, 4>> quads;  // counter-clockwise seen from outside
  std::vector<std::uint32_t> surface_of_quad;
  std::vector<SurfaceLook> surfaces;  // a surface is smooth: edges lie between surfaces
};

// A curved surface: point_at takes two numbers from 0 to 1, the picture is size.x() by size.y() metres large on it.
// Normals point to where u, the direction of the columns, v and they are right-handed.
void add_grid(QuadMesh& mesh, int columns, int rows, const std::function<Eigen::Vector3f(float u, float v)>& point_at,
              const Eigen::Vector2f& size, const SurfaceLook& look);

// A flat four-sided surface whose normal is along x cross along y, of facets no larger than max_facet metres.
void add_panel(QuadMesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& along_x,
               const Eigen::Vector3f& along_y, const SurfaceLook& look, float max_facet = 0.5f);

// The sides of a box; the picture is upright on the four that stand.
void add_box(QuadMesh& mesh, const Eigen::Isometry3f& world_from_box, const Eigen::Vector3f& half_size,
             const SurfaceLook& look, float max_facet = 0.5f);

// A round bar without ends, of so many facets around.
void add_bar(QuadMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius,
             const SurfaceLook& look, int facets = 8);

// A round bar of changing radius with both ends closed, upright or not: a bucket, a barrel.
void add_drum(QuadMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius,
              float to_radius, const SurfaceLook& look);

void add_ellipsoid(QuadMesh& mesh, const Eigen::Isometry3f& world_from_ellipsoid, const Eigen::Vector3f& radii,
                   const SurfaceLook& look, int facets = 10);

// The placement of an upright thing: where its origin stands, and radians to the left of the world's x axis.
Eigen::Isometry3f placed(const Eigen::Vector3f& position, float yaw = 0.0f);

}  // namespace byre
