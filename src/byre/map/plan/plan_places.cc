#include "byre/map/plan/plan_places.h"

#include "byre/geometry/degrees.h"
#include "byre/geometry/triangulation.h"
#include "byre/map/mapped_tag.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace byre {
namespace {

constexpr double kFarthestPixel = 10.0;

constexpr double kLeastAngle = 0.5 * kDegree;       // between the rays of a triangulated point
constexpr double kLeastDepression = 3.0 * kDegree;  // least angle of a ray below the horizon
constexpr double kFloorSigma = 0.02;                // metres, of the floor's height

const Calibration* calibration_of(const StoredMap& stored, const Keyframe& keyframe) {
  const auto recording = static_cast<std::size_t>(keyframe.recording);
  return recording < stored.recordings.size() ? &stored.recordings[recording].present_calibration() : nullptr;
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

std::optional<Eigen::Vector2d> rectified_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                               const Eigen::Vector2d& recorded) {
  const Calibration* const calibration = calibration_of(stored, keyframe);
  const auto bearing = calibration ? calibration->left.bearing(recorded) : std::optional<Eigen::Vector3d>();
  if (!bearing) return std::nullopt;
  const Rig& rig = rig_of(stored.map, keyframe);
  const Pose rectified_from_left = inverse(rig.body_from_camera) * calibration->body_from_left;
  const Eigen::Vector3d ray = rectified_from_left.rotation * *bearing;
  if (!(ray.z() > 0.0)) return std::nullopt;
  return rig.project(ray).head<2>();
}

std::optional<Eigen::Vector2d> recorded_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                              const Eigen::Vector2d& rectified) {
  const Calibration* const calibration = calibration_of(stored, keyframe);
  if (!calibration) return std::nullopt;
  const Rig& rig = rig_of(stored.map, keyframe);
  const Pose left_from_rectified = inverse(calibration->body_from_left) * rig.body_from_camera;
  return calibration->left.project(left_from_rectified.rotation * rig.ray(rectified));
}

std::optional<MapPosition> position_of_point(const StoredMap& stored, PointId id) {
  const MapPoint* const point = stored.map.find_point(id);
  if (point == nullptr) return std::nullopt;
  if (stored.scale != MapScale::metric) return MapPosition{point->position_in_world};
  return MapPosition{point->position_in_world, point->covariance};
}

std::optional<MapPosition> position_at_pixel(const StoredMap& stored, const Keyframe& keyframe,
                                             const Eigen::Vector2d& pixel) {
  const std::optional<Eigen::Vector2d> pixel_in_rig = rectified_pixel(stored, keyframe, pixel);
  const Sighting* const sighting = pixel_in_rig ? nearest_sighting(keyframe, *pixel_in_rig) : nullptr;
  std::optional<MapPosition> place = sighting ? position_of_point(stored, *sighting->point) : std::nullopt;
  if (!place || stored.scale != MapScale::metric) return place;
  const double depth = (keyframe.camera_from_world * place->point_in_map).z();
  const double distance =
      (sighting->pixel.cast<double>() - *pixel_in_rig).norm() * depth / rig_of(stored.map, keyframe).focal;
  place->covariance += distance * distance * Eigen::Matrix3d::Identity();
  return place;
}

double picked_pixel_sigma(const Rig& rig) {
  constexpr double kPictureSide = 376.0;  // pixels, longer side of a stored picture
  return std::max(1.0, std::max(rig.width, rig.height) / kPictureSide);
}

namespace {

struct View {
  const Keyframe& keyframe;
  const Rig& rig;
  Eigen::Vector2d pixel;
};

std::vector<View> views_of(const MapGraph& map, std::span<const KeyframePixel> pixels) {
  std::vector<View> views;
  for (const auto& [id, pixel] : pixels) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe != nullptr) views.push_back({*keyframe, rig_of(map, *keyframe), pixel});
  }
  return views;
}

struct ReprojectionEquations {
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
  double cost = 0.0;  // squared errors, in sigmas
};

// Empty if the point is behind a camera.
std::optional<ReprojectionEquations> reproject(const std::vector<View>& views, const Eigen::Vector3d& point_in_map) {
  ReprojectionEquations all;
  for (const auto& [keyframe, rig, pixel] : views) {
    const Eigen::Vector3d point = keyframe.camera_from_world * point_in_map;
    if (!(point.z() > 0.0)) return std::nullopt;
    const double sigma = picked_pixel_sigma(rig);
    const Eigen::Matrix<double, 2, 3> jacobian =
        rig.projection_jacobian(point).topRows<2>() * keyframe.camera_from_world.rotation.toRotationMatrix() / sigma;
    const Eigen::Vector2d error = (rig.project(point).head<2>() - pixel) / sigma;
    all.information += jacobian.transpose() * jacobian;
    all.gradient += jacobian.transpose() * error;
    all.cost += error.squaredNorm();
  }
  return all;
}

// Covariance of a point that is fixed to the keyframe, by that of the keyframe's pose.
Eigen::Matrix3d covariance_with_keyframe(const Keyframe& keyframe, const Eigen::Vector3d& point_in_map) {
  const Eigen::Matrix3d world_from_camera = keyframe.camera_from_world.rotation.conjugate().toRotationMatrix();
  Eigen::Matrix<double, 3, 6> jacobian;
  jacobian << world_from_camera, -world_from_camera * skew(keyframe.camera_from_world * point_in_map);
  return jacobian * keyframe.covariance * jacobian.transpose();
}

// The two-view triangulation by the pair of views with the widest angle.
std::optional<Eigen::Vector3d> widest_triangulation(const std::vector<View>& views) {
  std::optional<Eigen::Vector3d> best;
  double widest = kLeastAngle;
  for (const View& first : views) {
    const Pose map_from_first = inverse(first.keyframe.camera_from_world);
    const Eigen::Vector3d ray = first.rig.ray(first.pixel);
    for (const View& second : views) {
      const Pose second_from_first = second.keyframe.camera_from_world * map_from_first;
      const Eigen::Vector3d other = second.rig.ray(second.pixel);
      const double angle = std::atan2((second_from_first.rotation * ray).cross(other).norm(),
                                      (second_from_first.rotation * ray).dot(other));
      if (!(angle > widest)) continue;
      const auto point = triangulate(ray, other, second_from_first, kLeastAngle);
      if (!point) continue;
      best = map_from_first * *point;
      widest = angle;
    }
  }
  return best;
}

}  // namespace

std::optional<TriangulatedPoint> triangulate_pixels(const MapGraph& map, std::span<const KeyframePixel> pixels) {
  constexpr int kIterations = 10;
  constexpr double kLargestError = 3.3;  // sigmas of one degree of freedom: 0.1 %
  const std::vector<View> views = views_of(map, pixels);
  std::optional<Eigen::Vector3d> point = widest_triangulation(views);
  if (!point) return std::nullopt;
  std::optional<ReprojectionEquations> equations = reproject(views, *point);
  for (int i = 0; equations && i < kIterations; ++i) {
    const Eigen::Vector3d next = *point - equations->information.ldlt().solve(equations->gradient);
    const auto at_next = reproject(views, next);
    if (!at_next || !(at_next->cost < equations->cost)) break;
    point = next;
    equations = at_next;
  }
  if (!equations) return std::nullopt;
  const double freedom = 2.0 * static_cast<double>(views.size()) - 3.0;
  TriangulatedPoint result;
  result.position.point_in_map = *point;
  result.position.covariance = equations->information.inverse() + covariance_with_keyframe(views[0].keyframe, *point);
  result.error = std::sqrt(equations->cost / freedom);
  result.is_same_place = result.error < kLargestError;
  return result;
}

std::optional<MapPosition> floor_at_pixel(const MapGraph& map, const KeyframePixel& pixel, const DrivingPlane& plane,
                                          double body_height) {
  const std::vector<View> views = views_of(map, {&pixel, 1});
  if (views.empty()) return std::nullopt;
  const auto& [keyframe, rig, at] = views[0];
  const Pose map_from_camera = inverse(keyframe.camera_from_world);
  const Eigen::Vector3d ray = map_from_camera.rotation * rig.ray(at);
  const double fall = -plane.up_in_map.dot(ray);
  if (!(fall > std::sin(kLeastDepression) * ray.norm())) return std::nullopt;
  const double height = plane.up_in_map.dot(map_from_camera.translation - plane.point_in_map) + body_height;
  if (!(height > 0.0)) return std::nullopt;
  const double depth = height / fall;
  // The point moves along the ray by the height of the floor, and on the floor by the pixel.
  const Eigen::Matrix3d to_floor = Eigen::Matrix3d::Identity() + ray * plane.up_in_map.transpose() / fall;
  Eigen::Matrix<double, 3, 2> by_pixel =
      depth / rig.focal * to_floor * map_from_camera.rotation.toRotationMatrix().leftCols<2>();
  by_pixel *= picked_pixel_sigma(rig);
  const Eigen::Vector3d by_height = std::hypot(kFloorSigma, plane.thickness) / fall * ray;
  return MapPosition{map_from_camera.translation + depth * ray,
                     by_pixel * by_pixel.transpose() + by_height * by_height.transpose() +
                         covariance_with_keyframe(keyframe, map_from_camera.translation + depth * ray)};
}

PlanCorrespondence correspondence(std::string name, const MapPosition& place, const Eigen::Vector2d& point_in_plan,
                                  double pick_sigma) {
  return {std::move(name), place.point_in_map, point_in_plan, pick_sigma, place.covariance};
}

PlanCorrespondence wall_correspondence(std::string name, const MapPosition& start, const MapPosition& end,
                                       const Eigen::Vector2d& start_in_plan, const Eigen::Vector2d& end_in_plan,
                                       double pick_sigma) {
  PlanCorrespondence made = correspondence(std::move(name), start, start_in_plan, pick_sigma);
  made.wall = PlanWall{end.point_in_map, end.covariance, end_in_plan};
  return made;
}

std::vector<PlanCorrespondence> tag_correspondences(const StoredMap& stored, std::span<const Tag> tags) {
  std::vector<PlanCorrespondence> picks;
  for (const MappedTag& mapped : stored_tags(stored.notes)) {
    const auto tag = std::ranges::find(tags, mapped.id, &Tag::id);
    if (tag == tags.end() || !tag->survey) continue;
    picks.push_back({to_string(mapped.id), mapped.map_from_tag.translation, tag->survey->position.head<2>(),
                     std::hypot(tag->survey->sigma, mapped.sigma)});
  }
  return picks;
}

}  // namespace byre
