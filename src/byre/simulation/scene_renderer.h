#pragma once

#include "byre/pose.h"
#include "byre/simulation/barn_pictures.h"
#include "byre/simulation/lit_mesh.h"
#include "byre/simulation/pixel_rays.h"

#include <array>
#include <span>
#include <vector>

namespace byre {

// Air that is not clear: far surfaces fade into its own light.
struct Air {
  float haze = 0.0f;  // share of a surface's light lost in a metre, for small numbers
  float glow = 0.0f;  // radiance of the air itself
};

// What lights the scene at an instant.
struct Illumination {
  float share = 1.0f;      // share of the light that the scene was lit with, and of what glows by itself
  float headlight = 0.0f;  // radiance times square metres, straight ahead, of a lamp beside the camera
};

// A camera somewhere in the scene. Borrows the rays.
struct SceneView {
  const PixelRays& pixels;
  Pose world_from_camera;
  Illumination illumination{};
  // The same at each row's own instant, where the shutter rolls, else empty. What moves is then seen by the first row
  // as it is at the beginning, and by the last one as at the end.
  std::vector<Pose> world_from_camera_by_row{};
};

// One of the instants that an exposure is made of.
struct ExposureInstant {
  Eigen::Vector2f pixel_offset{0.0f, 0.0f};  // pixels by which all rays are off their pixels' centres
  bool smooth_edges = true;                  // more rays where surfaces end
};

// Renders a scene with Embree, eight rays at a time. Borrows all that it is given. The same view gives the same
// numbers, whatever the number of threads (0: as many as the machine has).
class SceneRenderer {
 public:
  SceneRenderer(const LitMesh& still, const BarnPictures& pictures, const Air& air, int threads)
      : still_(still), pictures_(pictures), air_(air), threads_(threads) {}

  // The radiance of each pixel at an instant, in the unit of the mesh's light, row-major; where nothing is it is the
  // air's. moving: what moves, at this instant.
  std::vector<float> radiance(const SceneView& view, const LitMesh& moving, const ExposureInstant& instant) const;

  // Depth along the optical axis at each pixel's centre, row-major, metres; infinite where nothing is.
  std::vector<float> depths(const SceneView& view, const LitMesh& moving) const;

 private:
  static constexpr int kRays = 8;  // rays in a packet

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
  const BarnPictures& pictures_;
  Air air_;
  int threads_;
};

}  // namespace byre
