#pragma once

#include "byre/simulation/cowshed/ray_casting.h"

#include <array>
#include <vector>

namespace byre {

// A mesh prepared for rendering: ray geometry and facet appearance.
class LitMesh {
 public:
  // light: radiance of a white surface at each vertex; id: see RayScene.
  LitMesh(const QuadMesh& mesh, const std::vector<float>& light, unsigned id,
          RayScene::Build build = RayScene::Build::careful)
      : LitMesh(mesh, mesh, light, id, build) {}

  // A moving mesh (see RayScene); its appearance is that of the beginning.
  LitMesh(const QuadMesh& begin, const QuadMesh& end, const std::vector<float>& light, unsigned id,
          RayScene::Build build);

  // Appearance of a facet. Arrays are by corner, in mesh order.
  struct Facet {
    std::array<Eigen::Vector2f, 4> texture_coordinates;
    std::array<float, 4> light;
    Eigen::Vector3f normal;            // unit length
    Eigen::Vector3f u_slope, v_slope;  // derivatives of the texture coordinates over the surface, textures per metre
    std::uint32_t surface = 0;
  };

  const RayScene& rays() const { return rays_; }
  const Facet& facet(unsigned index) const { return facets_[index]; }
  const Material& material(const Facet& facet) const { return materials_[facet.surface]; }
  float mean_light() const { return mean_light_; }

 private:
  RayScene rays_;
  std::vector<Facet> facets_;
  std::vector<Material> materials_;
  float mean_light_;
};

}  // namespace byre
