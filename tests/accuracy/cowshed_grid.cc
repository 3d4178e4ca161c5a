#include "cowshed_grid.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace byre {
namespace {

using Mask = std::vector<std::uint8_t>;

void mark(const FloorPlan& plan, const Eigen::Vector2d& point, Mask& mask) {
  const Eigen::Vector2d pixel = plan.pixel_at(point);
  const int column = static_cast<int>(std::lround(pixel.x())), row = static_cast<int>(std::lround(pixel.y()));
  if (column < 0 || row < 0 || column >= plan.width || row >= plan.height) return;
  mask[static_cast<std::size_t>(row * plan.width + column)] = 1;
}

// Whether a marked pixel has its centre within the distance.
bool is_near(const FloorPlan& plan, const Mask& mask, const Eigen::Vector2d& point, double distance) {
  const Eigen::Vector2d pixel = plan.pixel_at(point);
  const double radius = distance / plan.metres_per_pixel(0, 0);
  for (int row = static_cast<int>(std::ceil(pixel.y() - radius)); row <= pixel.y() + radius; ++row) {
    for (int column = static_cast<int>(std::ceil(pixel.x() - radius)); column <= pixel.x() + radius; ++column) {
      if (column < 0 || row < 0 || column >= plan.width || row >= plan.height) continue;
      if (mask[static_cast<std::size_t>(row * plan.width + column)] == 0) continue;
      if ((Eigen::Vector2d(column, row) - pixel).norm() <= radius) return true;
    }
  }
  return false;
}

// Marks samples of a mesh between the heights, 1 cm apart.
void mark_surfaces(const QuadMesh& mesh, const BarnView& view, BarnFromAbove& barn) {
  constexpr float kStep = 0.01f;
  for (const auto& quad : mesh.quads) {
    const Eigen::Vector3f &a = mesh.vertices[quad[0]], &b = mesh.vertices[quad[1]], &c = mesh.vertices[quad[2]],
                          &d = mesh.vertices[quad[3]];
    const int columns = 1 + static_cast<int>(std::max((b - a).norm(), (c - d).norm()) / kStep);
    const int rows = 1 + static_cast<int>(std::max((d - a).norm(), (c - b).norm()) / kStep);
    for (int row = 0; row <= rows; ++row) {
      const float v = static_cast<float>(row) / static_cast<float>(rows);
      for (int column = 0; column <= columns; ++column) {
        const float u = static_cast<float>(column) / static_cast<float>(columns);
        const Eigen::Vector3f point = (1 - v) * ((1 - u) * a + u * b) + v * ((1 - u) * d + u * c);
        if (point.z() < view.low || point.z() > view.high) continue;
        mark(barn.plan, point.head<2>().cast<double>(), barn.is_solid);
      }
    }
  }
}

// Rays with z = 1 of the pixels, row-major; zero where the lens has none.
std::vector<Eigen::Vector3d> rays_of(const Camera& camera) {
  std::vector<Eigen::Vector3d> rays;
  for (int row = 0; row < camera.height; ++row) {
    for (int column = 0; column < camera.width; ++column) {
      const auto bearing = camera.bearing({column, row});
      rays.emplace_back(bearing ? Eigen::Vector3d(*bearing / bearing->z()) : Eigen::Vector3d::Zero());
    }
  }
  return rays;
}

void mark_seen(const CowshedRecording& recording, Timestamp time, const std::vector<Eigen::Vector3d>& rays,
               const BarnView& view, BarnFromAbove& barn) {
  const Pose world_from_camera = recording.world_from_body(time) * recording.calibration().body_from_left;
  const std::vector<float> depths = recording.left_depths(time);
  for (std::size_t i = 0; i < rays.size(); ++i) {
    const Eigen::Vector3d in_camera = static_cast<double>(depths[i]) * rays[i];
    if (!(in_camera.norm() > 0.0 && in_camera.norm() <= view.range)) continue;
    const Eigen::Vector3d point = world_from_camera * in_camera;
    if (point.z() >= view.low && point.z() <= view.high) mark(barn.plan, point.head<2>(), barn.is_seen);
  }
}

}  // namespace

BarnFromAbove barn_from_above(const CowshedRecording& recording, const BarnView& view) {
  const FloorPlanImage drawn = draw_floor_plan(recording.barn().outlines);
  BarnFromAbove barn;
  barn.plan.width = drawn.image.width;
  barn.plan.height = drawn.image.height;
  barn.plan.metres_per_pixel = drawn.resolution * Eigen::Vector2d(1.0, -1.0).asDiagonal();
  barn.plan.top_left_in_plan = drawn.origin + drawn.resolution * Eigen::Vector2d(0.5, drawn.image.height - 0.5);
  for (const std::uint8_t grey : drawn.image.pixels) barn.is_wall.push_back(grey == 0 ? 1 : 0);
  barn.is_solid = barn.is_wall;
  barn.is_seen.assign(barn.is_wall.size(), 0);
  mark_surfaces(recording.barn().still, view, barn);
  const std::vector<Eigen::Vector3d> rays = rays_of(recording.calibration().left);
  Timestamp next = recording.times().front();
  for (const Timestamp time : recording.times()) {
    barn.driven.push_back(recording.world_from_body(time).translation.head<2>());
    if (time < next) continue;
    mark_seen(recording, time, rays, view, barn);
    next = time + from_seconds(view.interval_s);
  }
  return barn;
}

GridScore score_of(const FloorPlan& grid, std::span<const std::int8_t> occupancy, const BarnFromAbove& barn) {
  constexpr double kSeen = 0.05, kClose = 0.1;  // metres
  Mask is_occupied;
  for (const std::int8_t value : occupancy) is_occupied.push_back(value == kOccupiedPixel ? 1 : 0);
  GridScore score;
  int found = 0, right = 0;
  for (int row = 0; row < barn.plan.height; ++row) {
    for (int column = 0; column < barn.plan.width; ++column) {
      const Eigen::Vector2d point = barn.plan.point_at({column, row});
      if (barn.is_wall[static_cast<std::size_t>(row * barn.plan.width + column)] == 0) continue;
      if (!is_near(barn.plan, barn.is_seen, point, kSeen)) continue;
      ++score.walls;
      found += is_near(grid, is_occupied, point, kClose) ? 1 : 0;
    }
  }
  for (int row = 0; row < grid.height; ++row) {
    for (int column = 0; column < grid.width; ++column) {
      if (is_occupied[static_cast<std::size_t>(row * grid.width + column)] == 0) continue;
      ++score.occupied;
      right += is_near(barn.plan, barn.is_solid, grid.point_at({column, row}), kClose) ? 1 : 0;
    }
  }
  Mask is_driven(is_occupied.size(), 0);
  for (const Eigen::Vector2d& place : barn.driven) mark(grid, place, is_driven);
  for (std::size_t i = 0; i < is_driven.size(); ++i) {
    score.driven_occupied += is_driven[i] != 0 && is_occupied[i] != 0 ? 1 : 0;
  }
  score.found = score.walls > 0 ? static_cast<double>(found) / score.walls : 0.0;
  score.right = score.occupied > 0 ? static_cast<double>(right) / score.occupied : 0.0;
  return score;
}

}  // namespace byre
