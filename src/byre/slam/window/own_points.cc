#include "byre/slam/window/own_points.h"

#include "byre/geometry/median.h"
#include "byre/slam/window/model_sightings.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

namespace byre {
namespace {

// Median depth of the points in their reference views.
double median_depth(const Map& map) {
  std::vector<double> depths;
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    depths.push_back((map.camera_from_world(point.reference.keyframe) * point.position_in_world).z());
  }
  return median(std::move(depths));
}

std::optional<PointId> point_at(const Map& map, const Observation& seen) {
  return map.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)].point;
}

// The point of the map that most of these features show.
std::optional<PointId> known_point(const Map& map, const std::vector<Observation>& observations) {
  std::map<PointId, int> counts;
  for (const Observation& seen : observations) {
    if (const auto point = point_at(map, seen)) ++counts[*point];
  }
  if (counts.empty()) return std::nullopt;
  return std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; })->first;
}

Sighting as_seen(const Map& from, const Observation& seen, PointId point) {
  Sighting sighting = from.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
  sighting.point = point;
  return sighting;
}

void add_view(const SfmModel& model, PointId id, const Observation& seen, float max_error, Map& map) {
  const MapPoint& point = *map.find_point(id);
  const CameraView reference = view_of(model, static_cast<int>(point.reference.keyframe.number));
  const Eigen::Vector2f reference_pixel =
      map.find_keyframe(point.reference.keyframe)->sightings[static_cast<std::size_t>(point.reference.feature)].pixel;
  const auto measured =
      measure_against({reference, point.reference.feature, reference_pixel}, point.position_in_world,
                      view_of(model, static_cast<int>(seen.keyframe.number)), seen.feature, max_error);
  if (measured) map.add_observation(seen, {id, measured->pixel, measured->sigma});
}

}  // namespace

void add_own_points(const SfmModel& model, const ModelMapOptions& options, Map& map) {
  if (map.point_count() == 0) return;
  KnownPoseOptions own_options = options.own_points;
  own_options.assumed_depth = median_depth(map);
  const Map own = map_from_poses(model.rigs, model.images, own_options);
  for (const PointId own_id : own.point_ids()) {
    const std::vector<Observation>& observations = own.observations(own_id);
    if (const auto known = known_point(map, observations)) {
      for (const Observation& seen : observations) add_view(model, *known, seen, options.max_error, map);
      continue;
    }
    const PointId id = map.add_point(*own.find_point(own_id));
    for (const Observation& seen : observations) map.add_observation(seen, as_seen(own, seen, id));
  }
}

}  // namespace byre
