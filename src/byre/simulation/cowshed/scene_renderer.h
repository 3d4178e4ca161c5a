#pragma once

#include "byre/pose.h"
#include "byre/simulation/cowshed/barn_textures.h"
#include "byre/simulation/cowshed/lit_mesh.h"
#include "byre/simulation/pixel_rays.h"

#include <array>
#include <span>
#include <vector>

namespace byre {

// Hazy air: far surfaces fade into its own radiance.
struct Air {
  float haze = 0.0f;  // share of a surface's light lost per metre, for small values
  float glow = 0.0f;  // radiance of the air itself
};

struct Illumination {
  float share = 1.0f;      // multiplies the scene's light and glow
  float headlight = 0.0f;  // lamp at the camera, straight ahead: radiance times square metres
};

// A posed camera. Borrows the rays.
struct SceneView {
  const PixelRays& pixels;
  Pose world_from_camera;
  Illumination illumination{};
  // Pose of each row at its exposure time with a rolling shutter, else empty. Moving meshes then go from their
  // beginning at the first row to their end at the last.
  std::vector<Pose> world_from_camera_by_row{};
};

struct ExposureInstant {
  Eigen::Vector2f pixel_offset{0.0f, 0.0f};  // offset of all rays from the pixel centres
  bool smooth_edges = true;                  // additional rays at edges
};

// Renders a scene with Embree in packets of eight rays. Borrows its arguments. Deterministic for any number of threads
// (0: one per core).
class SceneRenderer {
 public:
  SceneRenderer(const LitMesh& still, const BarnTextures& textures, const Air& air, int threads)
      : still_(still), textures_(textures), air_(air), threads_(threads) {}

  // Radiance of each pixel at an instant, in the unit of the mesh's light, row-major; pixels without a surface get the
  // air's. moving: moving meshes at this instant.
  std::vector<float> radiance(const SceneView& view, const LitMesh& moving, const ExposureInstant& instant) const;

  // Depth along the optical axis at each pixel centre, row-major, metres; infinite without a surface.
  std::vector<float> depths(const SceneView& view, const LitMesh& moving) const;

 private:
  static constexpr int kRays = 8;  // rays per packet

  struct PlacedView;
  struct Target;
  struct Sample;
  struct RayFan;
  struct Packet;
  using Samples = std::array<Sample, kRays>;

  static PlacedView placed_view(const SceneView& view, const LitMesh& moving);
  Packet aimed(const PlacedView& view, std::span<const Target> targets) const;
  Samples trace(const PlacedView& view, std::span<const Target> targets) const;
  float radiance_of(const LitMesh& mesh, const LitMesh::Facet& facet, const Eigen::Vector2f& in_facet,
                    const RayFan& fan, float depth, const Illumination& illumination) const;
  std::vector<Sample> sample_centres(const PlacedView& view, const Eigen::Vector2f& offset) const;
  std::vector<float> smooth_row(const PlacedView& view, int row, const std::vector<Sample>& centres,
                                const Eigen::Vector2f& offset) const;

  const LitMesh& still_;
  const BarnTextures& textures_;
  Air air_;
  int threads_;
};

}  // namespace byre
