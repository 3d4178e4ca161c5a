#include "byre/simulation/cowshed/quad_mesh.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kRound = 2.0f * std::numbers::pi_v<float>;

int facets_along(float length, float max_facet) {
  return std::max(1, static_cast<int>(std::ceil(length / max_facet - 1e-3f)));
}

// Sums the facet normals at each vertex.
void add_normals(QuadMesh& mesh, std::size_t first_vertex, std::size_t first_quad) {
  for (std::size_t i = first_quad; i < mesh.quads.size(); ++i) {
    const auto& quad = mesh.quads[i];
    const Vector3f normal =
        (mesh.vertices[quad[2]] - mesh.vertices[quad[0]]).cross(mesh.vertices[quad[3]] - mesh.vertices[quad[1]]);
    for (const std::uint32_t vertex : quad) mesh.normals[vertex] += normal;
  }
  for (std::size_t i = first_vertex; i < mesh.normals.size(); ++i) mesh.normals[i].normalize();
}

// Two directions perpendicular to an axis, right-handed with it.
std::pair<Vector3f, Vector3f> across(const Vector3f& axis) {
  const Vector3f other = std::abs(axis.z()) < 0.9f ? Vector3f::UnitZ() : Vector3f::UnitX();
  const Vector3f first = other.cross(axis).normalized();
  return {first, axis.cross(first)};
}

// Lateral surface of a bar with linearly changing radius.
void add_mantle(QuadMesh& mesh, const Vector3f& from, const Vector3f& to, float from_radius, float to_radius,
                const Material& material, int facets) {
  const Vector3f bar = to - from;
  const auto [first, second] = across(bar.normalized());
  const auto point_at = [&, first = first, second = second](float u, float v) -> Vector3f {
    const float radius = from_radius + v * (to_radius - from_radius);
    return from + v * bar + radius * (std::cos(kRound * u) * first + std::sin(kRound * u) * second);
  };
  add_grid(mesh, facets, facets_along(bar.norm(), 1.0f), point_at,
           {kRound * std::max(from_radius, to_radius), bar.norm()}, material);
}

void add_disc(QuadMesh& mesh, const Vector3f& centre, const Vector3f& normal, float radius, const Material& material) {
  const auto [first, second] = across(normal);
  const auto point_at = [&, first = first, second = second](float u, float v) -> Vector3f {
    const float distance = radius * std::max(1.0f - v, 1e-3f);
    return centre + distance * (std::cos(kRound * u) * first + std::sin(kRound * u) * second);
  };
  add_grid(mesh, 12, 1, point_at, {kRound * radius, radius}, material);
}

}  // namespace

void add_grid(QuadMesh& mesh, int columns, int rows, const std::function<Vector3f(float u, float v)>& point_at,
              const Vector2f& size, const Material& material) {
  const std::size_t first_vertex = mesh.vertices.size();
  const std::size_t first_quad = mesh.quads.size();
  const auto surface = static_cast<std::uint32_t>(mesh.surfaces.size());
  const auto vertex = [&](int column, int row) {
    return static_cast<std::uint32_t>(first_vertex) + static_cast<std::uint32_t>(row * (columns + 1) + column);
  };
  for (int row = 0; row <= rows; ++row) {
    for (int column = 0; column <= columns; ++column) {
      const Vector2f part(static_cast<float>(column) / static_cast<float>(columns),
                          static_cast<float>(row) / static_cast<float>(rows));
      mesh.vertices.push_back(point_at(part.x(), part.y()));
      mesh.normals.emplace_back(Vector3f::Zero());
      mesh.texture_coordinates.push_back(material.texture_offset + part.cwiseProduct(size) / material.texture_width);
    }
  }
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      mesh.quads.push_back(
          {vertex(column, row), vertex(column + 1, row), vertex(column + 1, row + 1), vertex(column, row + 1)});
      mesh.surface_of_quad.push_back(surface);
    }
  }
  mesh.surfaces.push_back(material);
  add_normals(mesh, first_vertex, first_quad);
}

void add_panel(QuadMesh& mesh, const Vector3f& corner, const Vector3f& along_x, const Vector3f& along_y,
               const Material& material, float max_facet) {
  add_grid(
      mesh, facets_along(along_x.norm(), max_facet), facets_along(along_y.norm(), max_facet),
      [&](float u, float v) -> Vector3f { return corner + u * along_x + v * along_y; },
      {along_x.norm(), along_y.norm()}, material);
}

void add_box(QuadMesh& mesh, const Eigen::Isometry3f& world_from_box, const Vector3f& half_size,
             const Material& material, float max_facet) {
  const Vector3f centre = world_from_box.translation();
  const Vector3f x = world_from_box.linear().col(0) * half_size.x();
  const Vector3f y = world_from_box.linear().col(1) * half_size.y();
  const Vector3f z = world_from_box.linear().col(2) * half_size.z();
  const auto add_side = [&](const Vector3f& outward, const Vector3f& right, const Vector3f& up) {
    Material side_material = material;
    side_material.texture_offset.x() += 0.37f * static_cast<float>(mesh.surfaces.size() % 16);
    add_panel(mesh, centre + outward - right - up, 2.0f * right, 2.0f * up, side_material, max_facet);
  };
  add_side(-y, x, z);
  add_side(x, y, z);
  add_side(y, -x, z);
  add_side(-x, -y, z);
  add_side(z, x, y);
  add_side(-z, x, -y);
}

void add_bar(QuadMesh& mesh, const Vector3f& from, const Vector3f& to, float radius, const Material& material,
             int facets) {
  add_mantle(mesh, from, to, radius, radius, material, facets);
}

void add_drum(QuadMesh& mesh, const Vector3f& from, const Vector3f& to, float from_radius, float to_radius,
              const Material& material) {
  constexpr int kFacets = 16;
  const Vector3f axis = (to - from).normalized();
  add_mantle(mesh, from, to, from_radius, to_radius, material, kFacets);
  add_disc(mesh, from, -axis, from_radius, material);
  add_disc(mesh, to, axis, to_radius, material);
}

void add_ellipsoid(QuadMesh& mesh, const Eigen::Isometry3f& world_from_ellipsoid, const Vector3f& radii,
                   const Material& material, int facets) {
  const auto point_at = [&](float u, float v) -> Vector3f {
    const float height = std::numbers::pi_v<float> * (v - 0.5f) * 0.998f;  // leaves the poles a small width
    const Vector3f direction(std::cos(height) * std::cos(kRound * u), std::cos(height) * std::sin(kRound * u),
                             std::sin(height));
    return world_from_ellipsoid * Vector3f(radii.cwiseProduct(direction));
  };
  const Vector2f size(kRound * std::max(radii.x(), radii.y()), std::numbers::pi_v<float> * radii.z());
  add_grid(mesh, 2 * facets, facets, point_at, size, material);
}

Eigen::Isometry3f make_isometry(const Vector3f& position, float yaw) {
  return Eigen::Translation3f(position) * Eigen::AngleAxisf(yaw, Vector3f::UnitZ());
}

}  // namespace byre
