#include "byre/simulation/cowshed/barn_light.h"

#include "byre/simulation/row_workers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace byre {
namespace {

using Eigen::Vector3f;

constexpr int kCornerRays = 14;

// Cosine-weighted directions about the z axis (Fibonacci spiral).
std::array<Vector3f, kCornerRays> corner_directions() {
  std::array<Vector3f, kCornerRays> directions;
  for (int i = 0; i < kCornerRays; ++i) {
    const float part = (static_cast<float>(i) + 0.5f) / kCornerRays;
    const float angle = 2.399963f * static_cast<float>(i);
    const float sine = std::sqrt(part);
    directions[static_cast<std::size_t>(i)] = {sine * std::cos(angle), sine * std::sin(angle), std::sqrt(1.0f - part)};
  }
  return directions;
}

// Share of the nearby directions that no wall blocks.
float openness(const Vector3f& point, const Vector3f& normal, const RayScene& still) {
  constexpr float kReach = 1.8f;  // metres
  static const std::array<Vector3f, kCornerRays> kDirections = corner_directions();
  const Eigen::Quaternionf world_from_normal = Eigen::Quaternionf::FromTwoVectors(Vector3f::UnitZ(), normal);
  const auto is_open = [&](const Vector3f& direction) {
    return still.is_free(point, point + kReach * (world_from_normal * direction));
  };
  return static_cast<float>(std::ranges::count_if(kDirections, is_open)) / kCornerRays;
}

// Light that a white surface receives from a piece of a window; area of the piece in square metres.
float light_from_piece(const Vector3f& piece, const WindowLight& window, float area, const Vector3f& point,
                       const Vector3f& normal, const RayScene& still) {
  const Vector3f way = piece - point;
  const float squared = std::max(way.squaredNorm(), 0.25f);
  const float leaving = -way.dot(window.normal);
  const float arriving = way.dot(normal);
  if (leaving <= 0.0f || arriving <= 0.0f || !still.is_free(point, piece)) return 0.0f;
  return window.radiance * area * leaving * arriving / (std::numbers::pi_v<float> * squared * squared);
}

float light_from_window(const WindowLight& window, const Vector3f& point, const Vector3f& normal,
                        const RayScene& still) {
  const float quarter = window.half_x.cross(window.half_y).norm();  // quarter of the window's area, square metres
  float sum = 0.0f;
  for (const float x : {-0.5f, 0.5f}) {
    for (const float y : {-0.5f, 0.5f}) {
      const Vector3f piece = window.centre + x * window.half_x + y * window.half_y + 0.03f * window.normal;
      sum += light_from_piece(piece, window, quarter, point, normal, still);
    }
  }
  return sum;
}

float light_from_lamp(const Lamp& lamp, const Vector3f& point, const Vector3f& normal, const RayScene& still) {
  const Vector3f way = lamp.position - point;
  const float arriving = way.dot(normal);
  if (arriving <= 0.0f || !still.is_free(point, lamp.position)) return 0.0f;
  const float squared = std::max(way.squaredNorm(), 0.25f);
  return lamp.intensity * arriving / (squared * std::sqrt(squared));
}

float light_at(const Vector3f& point, const Vector3f& normal, const RayScene& still, const BarnLight& light) {
  float sum = light.ambient * (0.25f + 0.75f * openness(point, normal, still));
  for (const WindowLight& window : light.windows) sum += light_from_window(window, point, normal, still);
  for (const Lamp& lamp : light.lamps) sum += light_from_lamp(lamp, point, normal, still);
  return sum;
}

}  // namespace

std::vector<float> light_at_vertices(const QuadMesh& mesh, const RayScene& still, const BarnLight& light, int threads) {
  constexpr float kLift = 0.02f;  // metres off the surface, against self-shadowing
  constexpr int kAtOnce = 256;
  const int count = static_cast<int>(mesh.vertices.size());
  std::vector<float> result(mesh.vertices.size());
  for_each_row((count + kAtOnce - 1) / kAtOnce, threads, [&](int row) {
    for (int i = row * kAtOnce; i < std::min((row + 1) * kAtOnce, count); ++i) {
      const auto k = static_cast<std::size_t>(i);
      result[k] = light_at(mesh.vertices[k] + kLift * mesh.normals[k], mesh.normals[k], still, light);
    }
  });
  return result;
}

std::vector<float> plain_light_at_vertices(const QuadMesh& mesh, float mean) {
  std::vector<float> result;
  result.reserve(mesh.normals.size());
  for (const Vector3f& normal : mesh.normals) result.push_back(mean * (0.75f + 0.5f * normal.z()));
  return result;
}

}  // namespace byre
