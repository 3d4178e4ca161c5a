#include "byre/slam/places/offline_map.h"

#include "byre/geometry/median.h"
#include "byre/map/keyframe_path.h"
#include "byre/map/stored_calibration.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace byre {
namespace {

Matrix6 median_covariance(const MapGraph& map) {
  std::vector<double> position_variances, rotation_variances;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Matrix6& covariance = map.keyframe_header(id)->covariance;
    position_variances.push_back(position_variance(covariance) / 3.0);
    rotation_variances.push_back(rotation_variance(covariance) / 3.0);
  }
  Matrix6 result = Matrix6::Zero();
  result.topLeftCorner<3, 3>().diagonal().setConstant(median(position_variances));
  result.bottomRightCorner<3, 3>().diagonal().setConstant(median(rotation_variances));
  return result;
}

// Radius of most of the map's points around their middle, as a share of that of a room; at most 1.
double share_of_room(const MapGraph& map) {
  constexpr double kRoom = 3.5;   // metres
  constexpr double kMost = 0.8;   // share of the points
  constexpr double kLeast = 0.1;  // smallest result
  std::array<std::vector<double>, 3> coordinates;
  for (const PointId id : map.point_ids()) {
    const Eigen::Vector3d& position = map.find_point(id)->position_in_world;
    for (std::size_t axis = 0; axis < 3; ++axis) coordinates[axis].push_back(position[static_cast<int>(axis)]);
  }
  if (coordinates[0].empty()) return 1.0;
  std::vector<double> distances(coordinates[0].size(), 0.0);
  for (const std::vector<double>& along : coordinates) {
    const double middle = median(along);
    for (std::size_t i = 0; i < along.size(); ++i) distances[i] += std::pow(along[i] - middle, 2);
  }
  return std::clamp(std::sqrt(quantile(std::move(distances), kMost)) / kRoom, kLeast, 1.0);
}

}  // namespace

std::optional<PlacedWalls> place_walls(const MapGraph& map, const PlanRegistration& registration, PlanWalls walls) {
  constexpr double kMostApart = 2.0;    // metres between keyframes of one path
  constexpr double kDeep = 0.5;         // metres inside a wall
  constexpr double kMostInWalls = 0.1;  // share of the path
  std::vector<std::vector<Eigen::Vector2d>> ways;
  int places = 0, in_walls = 0;
  for (const StampedPose& body : keyframe_path(map)) {
    const Eigen::Vector2d place = (registration.plan_from_map * body.world_from_body.translation).head<2>();
    if (ways.empty() || (ways.back().back() - place).norm() > kMostApart) ways.emplace_back();
    ways.back().push_back(place);
    ++places;
    if (!walls.has_free_cell({place, kDeep})) ++in_walls;
  }
  if (in_walls > kMostInWalls * places) return std::nullopt;
  walls.clear_along_paths(ways);
  return PlacedWalls{registration, std::move(walls)};
}

OfflineMap::OfflineMap(MapGraph map, const Vocabulary& vocabulary, std::vector<SourceRecording> recordings,
                       std::optional<PlacedWalls> walls, const OdometryCalibration& extrinsics,
                       std::vector<MappedTag> tags)
    : map_(std::move(map)),
      places_(index_of(map_, vocabulary)),
      recordings_(std::move(recordings)),
      frame_covariance_(median_covariance(map_)),
      cell_unit_(share_of_room(map_)),
      ground_(DrivenGround::under(map_, up_of_base(extrinsics, recordings_))),
      walls_(std::move(walls)),
      extrinsics_(extrinsics),
      tags_(std::move(tags)) {
  for (const KeyframeId id : map_.keyframe_ids()) {
    const Pose world_from_camera = inverse(map_.keyframe_header(id)->camera_from_world);
    views_.push_back({id, world_from_camera.translation, world_from_camera.rotation * Eigen::Vector3d::UnitZ()});
  }
}

ScratchVector<KeyframeId> OfflineMap::keyframes_near(const Pose& camera_from_world, double max_distance,
                                                     int max_count) const {
  constexpr double kMaxAngle = 1.0;  // radians; views farther apart share hardly any points
  const Pose world_from_camera = inverse(camera_from_world);
  const Eigen::Vector3d direction = world_from_camera.rotation * Eigen::Vector3d::UnitZ();
  ScratchVector<std::pair<double, KeyframeId>> near;
  for (const View& view : views_) {
    const double distance = (view.camera_in_world - world_from_camera.translation).norm();
    if (distance > max_distance) continue;
    const double angle = std::acos(std::clamp(view.viewing_direction.dot(direction), -1.0, 1.0));
    if (angle <= kMaxAngle) near.emplace_back(distance + angle, view.keyframe);
  }
  std::ranges::sort(near);
  ScratchVector<KeyframeId> nearest;
  for (const auto& [distance, id] : near) {
    if (static_cast<int>(nearest.size()) >= max_count) break;
    nearest.push_back(id);
  }
  return nearest;
}

}  // namespace byre
