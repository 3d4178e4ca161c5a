#include "byre/simulation/cowshed/scene_renderer.h"

#include "byre/simulation/row_workers.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr unsigned kMovingBit = 0x80000000u;  // marks surfaces of the moving mesh
constexpr unsigned kNoSurface = 0xffffffffu;
constexpr float kNearest = 0.02f;  // near clipping distance, metres

// Offsets of additional rays at edges, from the pixel centre; their mean with the centre is the centre.
constexpr std::array<std::array<float, 2>, 2> kEdgeOffsets{{{0.33f, 0.17f}, {-0.33f, -0.17f}}};

// Bilinear interpolation, in the order of a facet's corners.
template <typename Value>
Value across_facet(const std::array<Value, 4>& corners, const Vector2f& in_facet) {
  const float u = in_facet.x();
  const float v = in_facet.y();
  return (1.0f - u) * (1.0f - v) * corners[0] + u * (1.0f - v) * corners[1] + u * v * corners[2] +
         (1.0f - u) * v * corners[3];
}

// Headlight that reaches a white surface. ray: to the surface, scaled to depth 1.
float headlight_on(const Vector3f& ray, float depth, const Vector3f& normal, float headlight) {
  constexpr int kBeamWidth = 6;  // half as bright 27 degrees off axis
  const float length = ray.norm();
  const float arriving = std::abs(ray.dot(normal)) / length;
  const float ahead = 1.0f / length;  // cosine of the angle to the optical axis
  const float distance = depth * length;
  return headlight * std::pow(ahead, kBeamWidth) * arriving / std::max(distance * distance, 0.25f);
}

}  // namespace

struct SceneRenderer::PlacedView {
  struct Placement {
    Eigen::Matrix3f world_from_camera;
    Vector3f origin;
  };

  bool rolls() const { return placements.size() > 1; }
  const Placement& placement(int row) const { return placements[rolls() ? static_cast<std::size_t>(row) : 0]; }
  float time(int row) const {  // in the range of RayScene
    return rolls() ? static_cast<float>(row) / static_cast<float>(placements.size() - 1) : 0.0f;
  }

  const PixelRays& pixels;
  const LitMesh& moving;
  Illumination illumination;
  std::vector<Placement> placements;  // one per row for a rolling shutter, else one
};

struct SceneRenderer::Target {
  int column = 0;
  int row = 0;
  Vector2f offset;
};

struct SceneRenderer::Sample {
  float radiance = 0.0f;
  float depth = std::numeric_limits<float>::infinity();
  unsigned surface = kNoSurface;
};

// Rays of a pixel and its neighbours in the world frame, scaled to depth 1.
struct SceneRenderer::RayFan {
  Vector3f ray;
  Vector3f to_right;
  Vector3f to_below;
};

struct SceneRenderer::Packet {
  alignas(32) std::array<int, kRays> valid{};  // Embree's convention: -1 or 0
  alignas(32) RTCRayHit8 rays;
  std::array<RayFan, kRays> fans;
};

float SceneRenderer::radiance_of(const LitMesh& mesh, const LitMesh::Facet& facet, const Vector2f& in_facet,
                                 const RayFan& fan, float depth, const Illumination& illumination) const {
  const Material& material = mesh.material(facet);
  if (material.glow > 0.0f) return illumination.share * material.glow;
  const Vector2f place = across_facet(facet.texture_coordinates, in_facet);
  const float facing = fan.ray.dot(facet.normal);
  const float slant = std::copysign(std::max(std::abs(facing), 0.02f), facing);
  const Vector3f right = depth * (fan.to_right - fan.ray * (fan.to_right.dot(facet.normal) / slant));
  const Vector3f down = depth * (fan.to_below - fan.ray * (fan.to_below.dot(facet.normal) / slant));
  const TextureFootprint footprint{{facet.u_slope.dot(right), facet.v_slope.dot(right)},
                                   {facet.u_slope.dot(down), facet.v_slope.dot(down)}};
  constexpr float kStainWidth = 7.3f;  // metres per texture of stains
  const float to_stains = material.texture_width / kStainWidth;
  const float stain = texture_of(textures_, BarnTexture::stains)
                          .sample(to_stains * place, to_stains * (footprint.right + footprint.down).norm());
  const float reflectance = material.brightness * texture_of(textures_, material.texture).sample(place, footprint);
  float light = illumination.share * across_facet(facet.light, in_facet);
  if (illumination.headlight > 0.0f) light += headlight_on(fan.ray, depth, facet.normal, illumination.headlight);
  return reflectance * (0.4f + 1.2f * stain) * light;
}

SceneRenderer::Packet SceneRenderer::aimed(const PlacedView& view, std::span<const Target> targets) const {
  Packet packet;
  for (std::size_t i = 0; i < targets.size(); ++i) {
    const auto corners = view.pixels.corners(targets[i].column, targets[i].row);
    if (!corners) continue;
    const PlacedView::Placement& camera = view.placement(targets[i].row);
    RayFan& fan = packet.fans[i];
    fan.ray = camera.world_from_camera * corners->at(0.5f + targets[i].offset.x(), 0.5f + targets[i].offset.y());
    fan.to_right = camera.world_from_camera * Vector3f(corners->top_right - corners->top_left);
    fan.to_below = camera.world_from_camera * Vector3f(corners->bottom_left - corners->top_left);
    packet.valid[i] = -1;
    RTCRay8& rays = packet.rays.ray;
    rays.org_x[i] = camera.origin.x();
    rays.org_y[i] = camera.origin.y();
    rays.org_z[i] = camera.origin.z();
    rays.dir_x[i] = fan.ray.x();
    rays.dir_y[i] = fan.ray.y();
    rays.dir_z[i] = fan.ray.z();
    rays.tnear[i] = kNearest;
    rays.tfar[i] = std::numeric_limits<float>::infinity();
    rays.time[i] = view.time(targets[i].row);
    rays.mask[i] = ~0u;
    rays.id[i] = 0;
    rays.flags[i] = 0;
    packet.rays.hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
  }
  return packet;
}

SceneRenderer::Samples SceneRenderer::trace(const PlacedView& view, std::span<const Target> targets) const {
  Packet packet = aimed(view, targets);
  still_.rays().intersect(packet.valid.data(), packet.rays);
  view.moving.rays().intersect(packet.valid.data(), packet.rays);
  const auto& [ray, hit] = packet.rays;
  Samples samples;
  const float glow = view.illumination.share * air_.glow;
  samples.fill({.radiance = glow});
  for (std::size_t i = 0; i < targets.size(); ++i) {
    if (packet.valid[i] == 0 || hit.geomID[i] == RTC_INVALID_GEOMETRY_ID) continue;
    const bool is_still = hit.geomID[i] == 0;
    const LitMesh& mesh = is_still ? still_ : view.moving;
    const LitMesh::Facet& facet = mesh.facet(hit.primID[i]);
    const float radiance =
        radiance_of(mesh, facet, {hit.u[i], hit.v[i]}, packet.fans[i], ray.tfar[i], view.illumination);
    const float clear = air_.haze > 0.0f ? std::exp(-air_.haze * ray.tfar[i]) : 1.0f;
    samples[i] = {glow + clear * (radiance - glow), ray.tfar[i], facet.surface | (is_still ? 0u : kMovingBit)};
  }
  return samples;
}

std::vector<SceneRenderer::Sample> SceneRenderer::sample_centres(const PlacedView& view, const Vector2f& offset) const {
  constexpr int kTileWidth = 4;
  constexpr int kTileHeight = kRays / kTileWidth;
  const int width = view.pixels.width();
  const int height = view.pixels.height();
  std::vector<Sample> samples(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for_each_row((height + kTileHeight - 1) / kTileHeight, threads_, [&](int tile_row) {
    for (int left = 0; left < width; left += kTileWidth) {
      std::array<Target, kRays> targets;
      std::size_t count = 0;
      for (int i = 0; i < kRays; ++i) {
        const Target target{left + i % kTileWidth, tile_row * kTileHeight + i / kTileWidth, offset};
        if (target.column < width && target.row < height) targets[count++] = target;
      }
      const Samples traced = trace(view, std::span(targets).first(count));
      for (std::size_t i = 0; i < count; ++i) {
        samples[static_cast<std::size_t>(targets[i].row * width + targets[i].column)] = traced[i];
      }
    }
  });
  return samples;
}

// Radiance of a row, with additional rays at edges.
std::vector<float> SceneRenderer::smooth_row(const PlacedView& view, int row, const std::vector<Sample>& centres,
                                             const Vector2f& offset) const {
  const int width = view.pixels.width();
  const auto at = [&](int column, int line) -> const Sample& {
    return centres[static_cast<std::size_t>(line * width + column)];
  };
  const auto ends_between = [](const Sample& a, const Sample& b) {
    return a.surface != b.surface || std::abs(a.depth - b.depth) > 0.1f * std::min(a.depth, b.depth);
  };
  const auto is_edge = [&](int column) {
    const Sample& here = at(column, row);
    return (column > 0 && ends_between(here, at(column - 1, row))) ||
           (column + 1 < width && ends_between(here, at(column + 1, row))) ||
           (row > 0 && ends_between(here, at(column, row - 1))) ||
           (row + 1 < view.pixels.height() && ends_between(here, at(column, row + 1)));
  };
  constexpr float kShare = 1.0f / (1.0f + static_cast<float>(kEdgeOffsets.size()));  // weight of each ray at an edge
  std::vector<Target> targets;
  std::vector<float> radiance;
  for (int column = 0; column < width; ++column) {
    const bool more_rays = is_edge(column);
    radiance.push_back((more_rays ? kShare : 1.0f) * at(column, row).radiance);
    if (!more_rays) continue;
    for (const auto& [x, y] : kEdgeOffsets) targets.push_back({column, row, offset + Vector2f(x, y)});
  }
  for (std::size_t first = 0; first < targets.size(); first += kRays) {
    const auto some = std::span(targets).subspan(first, std::min<std::size_t>(kRays, targets.size() - first));
    const Samples traced = trace(view, some);
    for (std::size_t i = 0; i < some.size(); ++i) {
      radiance[static_cast<std::size_t>(some[i].column)] += kShare * traced[i].radiance;
    }
  }
  return radiance;
}

SceneRenderer::PlacedView SceneRenderer::placed_view(const SceneView& view, const LitMesh& moving) {
  const auto placement = [](const Pose& world_from_camera) -> PlacedView::Placement {
    return {world_from_camera.rotation.toRotationMatrix().cast<float>(), world_from_camera.translation.cast<float>()};
  };
  PlacedView placed{view.pixels, moving, view.illumination, {}};
  for (const Pose& pose : view.world_from_camera_by_row) placed.placements.push_back(placement(pose));
  if (placed.placements.empty()) placed.placements.push_back(placement(view.world_from_camera));
  return placed;
}

std::vector<float> SceneRenderer::radiance(const SceneView& view, const LitMesh& moving,
                                           const ExposureInstant& instant) const {
  const PlacedView placed = placed_view(view, moving);
  const std::vector<Sample> centres = sample_centres(placed, instant.pixel_offset);
  std::vector<float> radiance;
  radiance.reserve(centres.size());
  for (const Sample& centre : centres) radiance.push_back(centre.radiance);
  if (!instant.smooth_edges) return radiance;
  for_each_row(view.pixels.height(), threads_, [&](int row) {
    const std::vector<float> smoothed = smooth_row(placed, row, centres, instant.pixel_offset);
    std::ranges::copy(smoothed, radiance.begin() + static_cast<std::ptrdiff_t>(row) * view.pixels.width());
  });
  return radiance;
}

std::vector<float> SceneRenderer::depths(const SceneView& view, const LitMesh& moving) const {
  std::vector<float> depths;
  for (const Sample& sample : sample_centres(placed_view(view, moving), {0.0f, 0.0f})) depths.push_back(sample.depth);
  return depths;
}

}  // namespace byre
