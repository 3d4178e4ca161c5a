#include "byre/map/plan/pick_guidance.h"

#include "byre/geometry/decompositions.h"
#include "byre/geometry/degrees.h"
#include "byre/geometry/median.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/LU>

namespace byre {
namespace {

constexpr std::size_t kPointsAround = 12;      // nearest points, whose keyframes see a place
constexpr std::size_t kMostViews = 6;          // further views offered
constexpr std::size_t kMostCandidates = 3000;  // points compared for the next pick
constexpr double kBestAngle = 20.0 * kDegree;  // between two views

Eigen::Vector3d centre_of(const Keyframe& keyframe) {
  return inverse(keyframe.camera_from_world).translation;
}

// Pixel of a point in a picture with a margin. Empty outside, and without a picture.
std::optional<Eigen::Vector2d> pixel_in_picture(const MapGraph& map, KeyframeId id, const Eigen::Vector3d& point) {
  const Keyframe* const keyframe = map.keyframe_header(id);
  if (keyframe == nullptr || !keyframe->picture) return std::nullopt;
  const Eigen::Vector3d in_camera = keyframe->camera_from_world * point;
  if (!(in_camera.z() > 0.0)) return std::nullopt;
  const Rig& rig = rig_of(map, *keyframe);
  const Eigen::Vector2d pixel = rig.project(in_camera).head<2>();
  return rig.contains(pixel, 0.04 * rig.width) ? std::optional(pixel) : std::nullopt;
}

// 1 at the best angle between two views of a point and at equal distance, down to 0.
double quality_of_pair(const Eigen::Vector3d& first_centre, const Eigen::Vector3d& second_centre,
                       const Eigen::Vector3d& point) {
  const Eigen::Vector3d first = first_centre - point, second = second_centre - point;
  const double angle = std::atan2(first.cross(second).norm(), first.dot(second));
  const double ratio = std::min(first.norm(), second.norm()) / std::max(first.norm(), second.norm());
  return ratio * std::min(angle / kBestAngle, kBestAngle / std::max(angle, 1e-9));
}

std::vector<PointId> points_around(const Keyframe& keyframe, const Eigen::Vector2d& pixel) {
  std::vector<std::pair<double, PointId>> nearest;
  for (const Sighting& sighting : keyframe.sightings) {
    if (sighting.point) nearest.emplace_back((sighting.pixel.cast<double>() - pixel).norm(), *sighting.point);
  }
  const std::size_t count = std::min(kPointsAround, nearest.size());
  std::ranges::partial_sort(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<PointId> points;
  for (std::size_t i = 0; i < count; ++i) points.push_back(nearest[i].second);
  return points;
}

// The two views of a point with the best angle. Empty with fewer than two in pictures.
std::vector<KeyframePixel> best_pair(const MapGraph& map, PointId id, const Eigen::Vector3d& point) {
  std::vector<KeyframePixel> views;
  for (const Observation& observation : map.observations(id)) {
    if (const auto pixel = pixel_in_picture(map, observation.keyframe, point))
      views.push_back({observation.keyframe, *pixel});
  }
  std::vector<KeyframePixel> best;
  double best_quality = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (std::size_t j = i + 1; j < views.size(); ++j) {
      const double quality = quality_of_pair(centre_of(*map.keyframe_header(views[i].keyframe)),
                                             centre_of(*map.keyframe_header(views[j].keyframe)), point);
      if (!(quality > best_quality)) continue;
      best_quality = quality;
      best = {views[i], views[j]};
    }
  }
  return best;
}

}  // namespace

std::vector<KeyframePixel> further_views(const MapGraph& map, const KeyframePixel& pixel) {
  const Keyframe* const keyframe = map.find_keyframe(pixel.keyframe);
  if (keyframe == nullptr) return {};
  const std::vector<PointId> around = points_around(*keyframe, pixel.pixel);
  if (around.empty()) return {};
  std::vector<double> depths;
  std::map<KeyframeId, int> votes;
  for (const PointId id : around) {
    depths.push_back((keyframe->camera_from_world * map.find_point(id)->position_in_world).z());
    for (const Observation& observation : map.observations(id)) ++votes[observation.keyframe];
  }
  const Eigen::Vector3d place = inverse(keyframe->camera_from_world) *
                                Eigen::Vector3d(median(std::move(depths)) * rig_of(map, *keyframe).ray(pixel.pixel));
  std::vector<std::pair<double, KeyframePixel>> views;
  for (const auto& [id, count] : votes) {
    const auto at = id == pixel.keyframe ? std::optional<Eigen::Vector2d>() : pixel_in_picture(map, id, place);
    if (!at) continue;
    const double quality = quality_of_pair(centre_of(*keyframe), centre_of(*map.keyframe_header(id)), place);
    views.emplace_back(-quality * std::sqrt(count), KeyframePixel{id, *at});
  }
  std::ranges::stable_sort(views, {}, [](const auto& view) { return view.first; });
  std::vector<KeyframePixel> best;
  for (std::size_t i = 0; i < std::min(kMostViews, views.size()); ++i) best.push_back(views[i].second);
  return best;
}

double width_of_view(const MapGraph& map, const Keyframe& keyframe, const Eigen::Vector3d& up_in_map) {
  const Eigen::Quaterniond level_from_map = rotation_between(up_in_map, Eigen::Vector3d::UnitZ());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  Eigen::Matrix2d squares = Eigen::Matrix2d::Zero();
  double count = 0.0;
  for (const Sighting& sighting : keyframe.sightings) {
    const MapPoint* const point = sighting.point ? map.find_point(*sighting.point) : nullptr;
    if (point == nullptr) continue;
    const Eigen::Vector2d position = (level_from_map * (point->position_in_world - centre_of(keyframe))).head<2>();
    sum += position;
    squares += position * position.transpose();
    count += 1.0;
  }
  if (count < 3.0) return 0.0;
  const Eigen::Matrix2d covariance = squares / count - sum * sum.transpose() / (count * count);
  return std::pow(std::max(0.0, covariance.determinant()), 0.25);
}

std::optional<NextPick> next_pick(const MapGraph& map, const DrivingPlane& plane, const PlanRegistration& registration,
                                  double pick_sigma) {
  const auto jacobian_at = [&](const Eigen::Vector3d& point) -> Eigen::Matrix<double, 2, 7> {
    return plan_jacobian(registration.plan_from_map, point).topRows<2>();
  };
  Matrix7 on_path = Matrix7::Zero();  // mean squared sigma on the path: trace(on_path * covariance)
  for (const Eigen::Vector3d& position : plane.path_in_map) {
    on_path += jacobian_at(position).transpose() * jacobian_at(position);
  }
  on_path /= static_cast<double>(plane.path_in_map.size());
  const std::vector<PointId> ids = map.point_ids();
  const std::size_t stride = 1 + ids.size() / kMostCandidates;
  std::vector<std::pair<double, PointId>> reductions;
  for (std::size_t i = 0; i < ids.size(); i += stride) {
    const Eigen::Matrix<double, 2, 7> jacobian = jacobian_at(map.find_point(ids[i])->position_in_world);
    const Eigen::Matrix<double, 2, 7> gain = jacobian * registration.covariance;
    const Eigen::Matrix2d innovation =
        gain * jacobian.transpose() + pick_sigma * pick_sigma * Eigen::Matrix2d::Identity();
    const double reduction = (innovation.inverse() * gain * on_path * gain.transpose()).trace();
    reductions.emplace_back(-reduction, ids[i]);
  }
  std::ranges::sort(reductions);
  const double before = (on_path * registration.covariance).trace();
  for (const auto& [negative, id] : reductions) {
    const Eigen::Vector3d& point = map.find_point(id)->position_in_world;
    std::vector<KeyframePixel> views = best_pair(map, id, point);
    if (views.empty()) continue;
    return NextPick{(registration.plan_from_map * point).head<2>(), std::move(views), std::sqrt(std::max(0.0, before)),
                    std::sqrt(std::max(0.0, before + negative))};
  }
  return std::nullopt;
}

}  // namespace byre
