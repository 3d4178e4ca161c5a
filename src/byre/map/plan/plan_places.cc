#include "byre/map/plan/plan_places.h"

#include <cmath>
#include <utility>

namespace byre {
namespace {

constexpr double kFarthestPixel = 10.0;

// Rectified pixel of a pixel of the left camera. Empty outside the field of view of the lens or the rig.
std::optional<Eigen::Vector2d> rectified(const Eigen::Vector2d& pixel, const Calibration& calibration, const Rig& rig) {
  const std::optional<Eigen::Vector3d> bearing = calibration.left.bearing(pixel);
  if (!bearing) return std::nullopt;
  const Pose rectified_from_left = inverse(rig.body_from_camera) * calibration.body_from_left;
  const Eigen::Vector3d ray = rectified_from_left.rotation * *bearing;
  if (!(ray.z() > 0.0)) return std::nullopt;
  return rig.project(ray).head<2>();
}

// The nearest sighting of a point; nullptr without one within kFarthestPixel.
const Sighting* nearest_sighting(const Keyframe& keyframe, const Eigen::Vector2d& pixel) {
  const Sighting* nearest = nullptr;
  double nearest_distance = kFarthestPixel;
  for (const Sighting& sighting : keyframe.sightings) {
    const double distance = (sighting.pixel.cast<double>() - pixel).norm();
    if (!sighting.point || distance > nearest_distance) continue;
    nearest_distance = distance;
    nearest = &sighting;
  }
  return nearest;
}

}  // namespace

std::optional<MapPosition> position_of_point(const StoredMap& stored, PointId id) {
  const MapPoint* const point = stored.map.find_point(id);
  if (point == nullptr) return std::nullopt;
  const bool is_metric = stored.scale == MapScale::metric;
  return MapPosition{point->position_in_world, is_metric ? std::sqrt(point->covariance.trace() / 3.0) : 0.0};
}

std::optional<MapPosition> position_at_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                             const Eigen::Vector2d& pixel) {
  const auto recording = static_cast<std::size_t>(keyframe.recording);
  if (recording >= stored.recordings.size()) return std::nullopt;
  const Rig& rig = stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  const std::optional<Eigen::Vector2d> pixel_in_rig =
      rectified(pixel, stored.recordings[recording].present_calibration(), rig);
  const Sighting* const sighting = pixel_in_rig ? nearest_sighting(keyframe, *pixel_in_rig) : nullptr;
  std::optional<MapPosition> place = sighting ? position_of_point(stored, *sighting->point) : std::nullopt;
  if (!place || stored.scale != MapScale::metric) return place;
  const double depth = (keyframe.camera_from_world * place->point_in_map).z();
  const double distance = (sighting->pixel.cast<double>() - *pixel_in_rig).norm();
  place->sigma = std::hypot(place->sigma, distance * depth / rig.focal);
  return place;
}

PlanCorrespondence correspondence(std::string name, const MapPosition& place, const Eigen::Vector2d& point_in_plan,
                                  double pick_sigma) {
  return {std::move(name), place.point_in_map, point_in_plan, std::hypot(pick_sigma, place.sigma)};
}

}  // namespace byre
