#include "byre/localisation/place_search.h"

#include "byre/localisation/standing_hint.h"
#include "byre/slam/keyframes.h"

#include <algorithm>

namespace byre {

Localisation localise_in(const OfflineMap& offline, const SoughtFrame& sought, const LocaliseOptions& options) {
  const auto& [frame, rig, hint] = sought;
  const Map nothing_online(Origin::online);
  const MapView map(&offline.map(), nothing_online);
  if (!hint) return localise(frame, rig, map, offline.places(), options);
  const Pose camera_from_body = inverse(rig.body_from_camera);
  // What is seen from there may have been mapped from farther back, and at an angle.
  constexpr double kTurnBetweenViews = 0.5;  // radians
  PoseHint around = *hint;
  around.radius *= 2.0;
  around.turn += kTurnBetweenViews;
  const auto is_far = [&map, &camera_from_body, &around](KeyframeId id) {
    return !is_near(around, inverse(map.find_keyframe(id)->camera_from_world) * camera_from_body);
  };
  Localisation found = localise(frame, rig, map, offline.places(), options, is_far);
  if (!found.tracked || is_near(*hint, inverse(found.tracked->camera_from_world) * camera_from_body)) return found;
  found.tracked.reset();
  found.failure = LocalisationFailure::geometry_disagrees;
  return found;
}

std::optional<FoundPlace> search_place(const OfflineMap& offline, const SoughtFrame& sought,
                                       const LocaliseOptions& options) {
  const Localisation found = localise_in(offline, sought, options);
  if (!found.tracked) return std::nullopt;
  const Map nothing_online(Origin::online);
  const double depth = median_depth(*found.tracked, MapView(&offline.map(), nothing_online));
  const double seen = static_cast<double>(found.tracked->features.size()) / std::max(1, found.tracked->expected);
  return FoundPlace{sought.frame.time, found.tracked->camera_from_world, depth, seen};
}

}  // namespace byre
