#pragma once

#include "byre/simulation/cowshed/barn_textures.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace byre {

struct Material {
  BarnTexture texture = BarnTexture::concrete;
  float brightness = 1.0f;     // multiplies the texture's reflectance
  float texture_width = 2.0f;  // metres of surface per texture width
  Eigen::Vector2f texture_offset{0.0f, 0.0f};
  float glow = 0.0f;  // radiance; a glowing surface shows neither texture nor light
};

// Surfaces of four-sided facets, in the world frame, metres.
struct QuadMesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Eigen::Vector3f> normals;              // per vertex, unit length, away from the solid
  std::vector<Eigen::Vector2f> texture_coordinates;  // texture coordinates per vertex, in textures
  std::vector<std::array<std::uint32_t, 4>> quads;   // counter-clockwise seen from outside
  std::vector<std::uint32_t> surface_of_quad;
  std::vector<Material> surfaces;  // shading is smooth within a surface
};

// A curved surface. point_at takes u (along columns) and v (along rows), both 0 to 1; the texture covers size.x() by
// size.y() metres. u, v and the normal are right-handed.
void add_grid(QuadMesh& mesh, int columns, int rows, const std::function<Eigen::Vector3f(float u, float v)>& point_at,
              const Eigen::Vector2f& size, const Material& material);

// A flat four-sided surface with normal along_x cross along_y and facets of at most max_facet metres.
void add_panel(QuadMesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& along_x,
               const Eigen::Vector3f& along_y, const Material& material, float max_facet = 0.5f);

// The six sides of a box; the texture is upright on the four vertical ones.
void add_box(QuadMesh& mesh, const Eigen::Isometry3f& world_from_box, const Eigen::Vector3f& half_size,
             const Material& material, float max_facet = 0.5f);

// A round bar with open ends; facets: number around its axis.
void add_bar(QuadMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float radius,
             const Material& material, int facets = 8);

// A round bar of changing radius with closed ends, such as a bucket or barrel.
void add_drum(QuadMesh& mesh, const Eigen::Vector3f& from, const Eigen::Vector3f& to, float from_radius,
              float to_radius, const Material& material);

void add_ellipsoid(QuadMesh& mesh, const Eigen::Isometry3f& world_from_ellipsoid, const Eigen::Vector3f& radii,
                   const Material& material, int facets = 10);

// world_from_object of an upright object: position of its origin, yaw in radians to the left of the world's x axis.
Eigen::Isometry3f make_isometry(const Eigen::Vector3f& position, float yaw = 0.0f);

}  // namespace byre
