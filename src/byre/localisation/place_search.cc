#include "byre/localisation/place_search.h"

#include "byre/localisation/standing_hint.h"
#include "byre/slam/body_pose.h"
#include "byre/slam/keyframes.h"
#include "byre/slam/place_hypothesis.h"

#include <algorithm>
#include <utility>

namespace byre {
namespace {

PlaceToJudge place_of(const TrackedFrame& tracked, const SoughtFrame& sought) {
  const Rig& rig = sought.rig;
  return {sought.frame.time, body_pose(rig, tracked.camera_from_world),
          move_covariance(tracked.match_covariance, rig.body_from_camera)};
}

// Keyframes that show the scene around a hint may be farther back, and at another angle.
PoseHint surroundings_of(const PoseHint& hint) {
  constexpr double kTurnBetweenViews = 0.5;  // radians
  PoseHint around = hint;
  around.radius *= 2.0;
  around.turn += kTurnBetweenViews;
  return around;
}

}  // namespace

BoundedLocalisation localise_in(const OfflineMap& offline, const SoughtFrame& sought,
                                const PlaceSearchOptions& options) {
  const auto& [frame, rig, hint, way, hidden] = sought;
  LocaliseOptions localise_options = options.localise;
  localise_options.hidden = hidden;
  const Map nothing_online(Origin::online);
  const MapView map(&offline.map(), nothing_online);
  const PlaceBounds bounds(offline, options.bounds);
  BoundedLocalisation result;
  PlaceFilter filter;
  filter.is_impossible = [&](const TrackedFrame& tracked) {
    const Doubt reason = bounds.reason_against(place_of(tracked, sought), sought.way);
    if (reason != Doubt::none) result.refused = reason;
    return reason != Doubt::none;
  };
  const Pose camera_from_body = inverse(rig.body_from_camera);
  if (hint) {
    filter.is_excluded = [&map, &camera_from_body, around = surroundings_of(*hint)](KeyframeId id) {
      return !is_near(around, inverse(map.find_bare_keyframe(id)->camera_from_world) * camera_from_body);
    };
  }
  Localisation& found = result.found;
  found = localise(frame, rig, map, offline.places(), localise_options, filter);
  if (!hint) return result;
  const auto is_elsewhere = [&](const TrackedFrame& tracked) {
    return !is_near(*hint, inverse(tracked.camera_from_world) * camera_from_body);
  };
  std::erase_if(found.places_found, is_elsewhere);
  if (!found.tracked || !is_elsewhere(*found.tracked)) return result;
  found.tracked.reset();
  found.failure = LocalisationFailure::geometry_disagrees;
  return result;
}

PlaceSearch search_place(const OfflineMap& offline, const SoughtFrame& sought, const PlaceSearchOptions& options) {
  const auto [found, refused] = localise_in(offline, sought, options);
  PlaceSearch search{sought.frame.time, sought.rig, std::nullopt, refused};
  for (const TrackedFrame& place : found.places_found) search.places.push_back(place.camera_from_world);
  if (!found.tracked) return search;
  const Map nothing_online(Origin::online);
  const double depth = median_depth(*found.tracked, MapView(&offline.map(), nothing_online));
  const ReusedVector<PointId> around =
      local_points(MapView(&offline.map(), nothing_online), found.tracked->reference, kKeyframesOfPlace);
  const ReusedVector<PointId> nearby =
      points_of_place(offline, keyframes_of_place(offline, found.tracked->camera_from_world));
  PlaceView view =
      view_of_place({offline.map(), sought.rig, sought.frame, *found.tracked, nearby, around, sought.hidden});
  search.found = FoundPlace{found.tracked->camera_from_world, depth, std::move(view)};
  search.refused = Doubt::none;
  return search;
}

}  // namespace byre
