#pragma once

#include "byre/simulation/ray_casting.h"

#include <vector>

namespace byre {

// A window or skylight: a parallelogram that shines into the half space that its normal points to.
struct WindowLight {
  Eigen::Vector3f centre;
  Eigen::Vector3f half_x;
  Eigen::Vector3f half_y;
  Eigen::Vector3f normal;  // unit length
  float radiance = 0.0f;
};

struct Lamp {
  Eigen::Vector3f position;
  float intensity = 0.0f;  // radiance times square metres
};

// Where the light of a barn comes from. Radiances have a unit of their own: the camera's exposure control settles it.
struct BarnLight {
  std::vector<WindowLight> windows{};
  std::vector<Lamp> lamps{};
  float ambient = 0.0f;  // radiance from everywhere, less in corners
};

// What a white surface at each vertex of a mesh sends out, shadows and corners included. still: what shadows fall from.
// The same whatever the number of threads (0: as many as the machine has).
std::vector<float> light_at_vertices(const QuadMesh& mesh, const RayScene& still, const BarnLight& light, int threads);

// For what moves: without shadows, light comes from above more than from below. mean: the scene's own.
std::vector<float> plain_light_at_vertices(const QuadMesh& mesh, float mean);

}  // namespace byre
