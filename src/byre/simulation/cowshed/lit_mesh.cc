#include "byre/simulation/cowshed/lit_mesh.h"

#include <algorithm>
#include <numeric>

namespace byre {
namespace {

// Slopes of the texture coordinates: they change by the diagonals' differences along the diagonals and are constant
// across the facet's plane.
void set_slopes(LitMesh::Facet& facet, const Eigen::Vector3f& first_diagonal, const Eigen::Vector3f& second_diagonal) {
  const Eigen::Vector3f area = first_diagonal.cross(second_diagonal);
  const float squared = std::max(area.squaredNorm(), 1e-20f);
  const Eigen::Vector3f first_dual = second_diagonal.cross(area) / squared;
  const Eigen::Vector3f second_dual = area.cross(first_diagonal) / squared;
  const auto& places = facet.texture_coordinates;
  const Eigen::Vector2f along_first = places[2] - places[0];
  const Eigen::Vector2f along_second = places[3] - places[1];
  facet.normal = area / std::sqrt(squared);
  facet.u_slope = along_first.x() * first_dual + along_second.x() * second_dual;
  facet.v_slope = along_first.y() * first_dual + along_second.y() * second_dual;
}

float mean_of(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0f) /
         static_cast<float>(std::max<std::size_t>(values.size(), 1));
}

}  // namespace

LitMesh::LitMesh(const QuadMesh& mesh, const QuadMesh& end, const std::vector<float>& light, unsigned id,
                 RayScene::Build build)
    : rays_(mesh, end, id, build), materials_(mesh.surfaces), mean_light_(mean_of(light)) {
  facets_.reserve(mesh.quads.size());
  for (std::size_t i = 0; i < mesh.quads.size(); ++i) {
    const auto& quad = mesh.quads[i];
    Facet facet;
    facet.surface = mesh.surface_of_quad[i];
    for (std::size_t corner = 0; corner < 4; ++corner) {
      facet.texture_coordinates[corner] = mesh.texture_coordinates[quad[corner]];
      facet.light[corner] = light[quad[corner]];
    }
    set_slopes(facet, mesh.vertices[quad[2]] - mesh.vertices[quad[0]], mesh.vertices[quad[3]] - mesh.vertices[quad[1]]);
    facets_.push_back(facet);
  }
}

}  // namespace byre
