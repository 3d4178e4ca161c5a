#pragma once

#include "byre/simulation/cowshed/ray_casting.h"

#include <vector>

namespace byre {

// A window or skylight: a parallelogram that shines into the half space of its normal.
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

// Light sources of a barn. The unit of radiance is arbitrary: automatic exposure compensates for it.
struct BarnLight {
  std::vector<WindowLight> windows{};
  std::vector<Lamp> lamps{};
  float ambient = 0.0f;  // radiance from everywhere, less in corners
};

// Light that a white surface reflects at each vertex of a mesh, with shadows and darker corners. still: casts the
// shadows. The result does not depend on the number of threads (0: one per core).
std::vector<float> light_at_vertices(const QuadMesh& mesh, const RayScene& still, const BarnLight& light, int threads);

// Shadowless light for moving meshes, stronger from above than from below. mean: mean light of the scene.
std::vector<float> plain_light_at_vertices(const QuadMesh& mesh, float mean);

}  // namespace byre
