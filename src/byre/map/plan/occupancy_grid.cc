#include "byre/map/plan/occupancy_grid.h"

#include "byre/geometry/decompositions.h"
#include "byre/input_error.h"
#include "byre/map/keyframe_path.h"
#include "byre/map/plan/grid_evidence.h"
#include "byre/map/plan/path_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

using Eigen::AlignedBox2d;
using Eigen::Vector2d;
using Eigen::Vector3d;

// Origin and x axis of the map, projected onto the driving plane; the y axis instead if x is nearly vertical.
Similarity ground_from(const DrivingPlane& plane, double body_height) {
  const Vector3d& up = plane.up_in_map;
  const bool is_upright = std::abs(up.x()) > std::numbers::sqrt2 / 2.0;
  const Vector3d along = is_upright ? Vector3d::UnitY() : Vector3d::UnitX();
  Eigen::Matrix3d rotation;
  rotation.row(2) = up;
  rotation.row(0) = (along - along.dot(up) * up).normalized();
  rotation.row(1) = up.cross(rotation.row(0).transpose());
  const double floor = up.dot(plane.point_in_map) - body_height;
  return {1.0, {Eigen::Quaterniond(rotation), {0.0, 0.0, -floor}}};
}

double height_of_body(const MapGraph& map, const Vector3d& up_in_map, const GridOptions& options) {
  if (options.body_height) return *options.body_height;
  constexpr double kUpright = 0.7;  // cosine of 45 degrees
  double upright = 0.0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    upright += up_in_map.dot(world_from_body(map, keyframe).rotation * Vector3d::UnitZ()) / map.keyframe_count();
  }
  if (upright > kUpright) return 0.0;
  throw InputError("occupancy grid",
                   "the z axis of the map's body does not point up, as for a camera, so its height "
                   "above the floor is unknown",
                   "give the height of the body's origin above the floor, such as --body-height 0.9");
}

// Keyframe in the grid's frame.
struct DrivenPose {
  Vector3d body;
  Vector3d camera;
  Eigen::Quaterniond rotation;  // camera_from_world
  double floor = 0.0;           // height of the floor under the body
  Timestamp time{};
  int recording = 0;
};

// The floor follows the mean height of the path within this distance, so that ramps and drift do not lift the band.
constexpr double kAround = 3.0;  // metres

constexpr double kLongestLink = 0.6;  // metres, between points on a line that are joined

std::vector<DrivenPose> driven_poses(const MapGraph& map, const Similarity& plan_from_map) {
  std::vector<DrivenPose> poses;
  std::vector<Vector3d> places;
  double mean_height = 0.0;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.keyframe_header(id);
    DrivenPose pose;
    pose.body = plan_from_map * body_at(map, keyframe);
    pose.camera = plan_from_map * inverse(keyframe.camera_from_world).translation;
    pose.rotation = keyframe.camera_from_world.rotation;
    pose.time = keyframe.frame.time;
    pose.recording = keyframe.recording;
    mean_height += pose.body.z() / map.keyframe_count();
    places.push_back(pose.body);
    poses.push_back(pose);
  }
  const PathCells cells(places, kAround);
  for (DrivenPose& pose : poses) {
    double sum = 0.0;
    int count = 0;
    for (const std::uint32_t i : cells.near(pose.body)) {
      if ((places[i] - pose.body).squaredNorm() > kAround * kAround) continue;
      sum += places[i].z();
      ++count;
    }
    pose.floor = sum / count - mean_height;
  }
  return poses;
}

// Points with enough observations. Their floor is that of the nearest keyframe that observes them.
std::vector<GridPoint> grid_points(const MapGraph& map, const Similarity& plan_from_map,
                                   const std::vector<DrivenPose>& poses, const std::vector<std::uint32_t>& pose_of,
                                   const GridOptions& options) {
  std::vector<GridPoint> points;
  const Eigen::Matrix3d turn = plan_from_map.scale * plan_from_map.target_from_source.rotation.toRotationMatrix();
  for (const PointId id : map.point_ids()) {
    const std::vector<Observation>& observations = map.observations(id);
    if (static_cast<int>(observations.size()) < options.least_observations) continue;
    const MapPoint& point = *map.find_point(id);
    GridPoint made;
    made.position = plan_from_map * point.position_in_world;
    made.covariance = turn * point.covariance * turn.transpose();
    for (const Observation& observation : observations) made.scans.push_back(pose_of[observation.keyframe.number]);
    const std::uint32_t nearest = *std::ranges::min_element(
        made.scans, {}, [&](std::uint32_t scan) { return (poses[scan].camera - made.position).squaredNorm(); });
    made.position.z() -= poses[nearest].floor;
    const double variance = symmetric_eigenvalues(Eigen::Matrix2d(made.covariance.topLeftCorner<2, 2>()))[1];
    made.is_obstacle = made.position.z() >= options.low && made.position.z() <= options.high &&
                       variance <= options.largest_sigma * options.largest_sigma;
    points.push_back(std::move(made));
  }
  return points;
}

// Whether the robot drove straight from one keyframe to the next: they are close in space or time, and the arc between
// them is at most half the footprint's radius from the chord.
bool drove_straight(const DrivenPose& from, const DrivenPose& to, double footprint_radius) {
  constexpr double kClose = 1.0;  // metres
  constexpr double kSoon = 2.0;   // seconds
  if (from.recording != to.recording) return false;
  const double length = (to.body - from.body).norm();
  if (length > kClose && to_seconds(to.time - from.time) > kSoon) return false;
  return length * angle_between(from.rotation, to.rotation) / 8.0 <= 0.5 * footprint_radius;
}

// Positions along the path at most half a cell apart.
std::vector<Vector2d> driven_places(std::vector<DrivenPose> poses, const GridOptions& options) {
  std::ranges::sort(poses, {}, [](const DrivenPose& pose) { return std::pair(pose.recording, pose.time); });
  std::vector<Vector2d> places;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Vector2d to = poses[i].body.head<2>();
    if (i > 0 && drove_straight(poses[i - 1], poses[i], options.footprint_radius)) {
      const Vector2d from = poses[i - 1].body.head<2>();
      const int pieces = static_cast<int>(2.0 * (to - from).norm() / options.resolution);
      for (int piece = 1; piece <= pieces; ++piece) {
        places.push_back(from + (to - from) * (static_cast<double>(piece) / (pieces + 1)));
      }
    }
    places.push_back(to);
  }
  return places;
}

// Corners on multiples of the resolution, so that grids of one map align.
FloorPlan placement_of(const AlignedBox2d& box, double resolution) {
  const Vector2d low = (box.min() / resolution).array().floor() - 1.0;
  const Vector2d high = (box.max() / resolution).array().ceil() + 1.0;
  const Vector2d size = high - low;
  if (!(size.x() * size.y() <= kMaxGridCells)) {
    const double coarser = resolution * std::sqrt(size.x() * size.y() / kMaxGridCells);
    throw InputError(
        "occupancy grid",
        fmt::format("has {:.0f} x {:.0f} cells of {:g} m; the limit is 100 million", size.x(), size.y(), resolution),
        fmt::format("choose a resolution of {:.2f} m or more", 1.01 * coarser + 0.005));
  }
  FloorPlan plan;
  plan.width = static_cast<int>(size.x());
  plan.height = static_cast<int>(size.y());
  plan.metres_per_pixel = Vector2d(resolution, -resolution).asDiagonal();
  plan.top_left_in_plan = resolution * Vector2d(low.x() + 0.5, high.y() - 0.5);
  plan.occupied_threshold = 0.65;
  return plan;
}

void free_driven_cells(const std::vector<Vector2d>& places, double radius, OccupancyGrid& grid) {
  const double resolution = grid.plan.metres_per_pixel(0, 0);
  const int reach = static_cast<int>(std::ceil(radius / resolution));
  for (const Vector2d& place : places) {
    const Vector2d pixel = grid.plan.pixel_at(place);
    const int middle_column = static_cast<int>(std::lround(pixel.x()));
    const int middle_row = static_cast<int>(std::lround(pixel.y()));
    for (int row = middle_row - reach; row <= middle_row + reach; ++row) {
      for (int column = middle_column - reach; column <= middle_column + reach; ++column) {
        if (column < 0 || row < 0 || column >= grid.plan.width || row >= grid.plan.height) continue;
        const bool is_under_body = column == middle_column && row == middle_row;
        if (!is_under_body && resolution * (Vector2d(column, row) - pixel).norm() > radius) continue;
        grid.occupancy[static_cast<std::size_t>(row) * grid.plan.width + column] = kFreePixel;
      }
    }
  }
}

}  // namespace

std::optional<OccupancyGrid> occupancy_grid(const MapGraph& map, const std::optional<PlanRegistration>& registration,
                                            const GridOptions& options, std::optional<DrivingPlane> plane) {
  constexpr double kRoughest = 0.1;  // largest thickness of the path relative to its length
  if (!plane) plane = fit_driving_plane(map, {});
  if (!plane || plane->thickness > kRoughest * plane->length) return std::nullopt;
  OccupancyGrid grid;
  grid.plan_from_map =
      registration ? registration->plan_from_map : ground_from(*plane, height_of_body(map, plane->up_in_map, options));

  const std::vector<DrivenPose> poses = driven_poses(map, grid.plan_from_map);
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  std::vector<std::uint32_t> pose_of(ids.back().number + 1, 0);
  for (std::uint32_t i = 0; i < ids.size(); ++i) pose_of[ids[i].number] = i;
  const std::vector<GridPoint> points = grid_points(map, grid.plan_from_map, poses, pose_of, options);
  const std::vector<Vector2d> driven = driven_places(poses, options);

  AlignedBox2d box;
  for (const Vector2d& place : driven) {
    box.extend(Vector2d(place.array() - options.footprint_radius));
    box.extend(Vector2d(place.array() + options.footprint_radius));
  }
  for (const GridPoint& point : points) {
    if (point.is_obstacle) box.extend(Vector2d(point.position.head<2>()));
  }
  grid.plan = placement_of(box, options.resolution);

  std::vector<Vector3d> cameras;
  for (const DrivenPose& pose : poses) cameras.emplace_back(pose.camera - pose.floor * Vector3d::UnitZ());
  grid.occupancy = occupancy_by_rays(
      grid.plan, points, cameras, {options.low, options.high, std::min(2.0 * options.footprint_radius, kLongestLink)});
  free_driven_cells(driven, options.footprint_radius, grid);
  return grid;
}

}  // namespace byre
