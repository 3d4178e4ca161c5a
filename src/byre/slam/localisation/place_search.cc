#include "byre/slam/localisation/place_search.h"

#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/keyframes.h"

#include <cmath>
#include <utility>

namespace byre {
namespace {

PlaceCandidatePose place_of(const TrackedFrame& tracked, const PlaceQuery& query) {
  const Rig& rig = query.rig;
  return {query.frame.time, body_pose(rig, tracked.camera_from_world),
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

bool is_near(const PoseHint& hint, const Pose& map_from_body) {
  return (map_from_body.translation - hint.map_from_body.translation).norm() <= hint.radius &&
         angle_between(map_from_body.rotation, hint.map_from_body.rotation) <= hint.turn;
}

void ActiveHint::set_hint(const PoseHint& hint) {
  const Pose& pose = hint.map_from_body;
  const bool is_finite = pose.translation.allFinite() && pose.rotation.coeffs().allFinite() &&
                         std::isfinite(hint.radius) && std::isfinite(hint.turn) && std::isfinite(hint.seconds);
  hint_ = is_finite ? std::optional(hint) : std::nullopt;
  first_frame_.reset();
}

void ActiveHint::expire(Timestamp frame) {
  if (!hint_) return;
  if (!first_frame_) first_frame_ = frame;
  if (to_seconds(frame - *first_frame_) >= hint_->seconds) hint_.reset();
}

BoundedLocalisation localise_in(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options) {
  const auto& [frame, rig, hint, reach, hidden] = query;
  LocaliseOptions localise_options = options.localise;
  localise_options.hidden = hidden;
  localise_options.tags = offline.tags();
  const MapGraph nothing_online(Origin::online);
  const MapView map(&offline.map(), nothing_online);
  const PlaceBounds bounds(offline, options.bounds);
  BoundedLocalisation result;
  PlaceFilter filter;
  filter.is_impossible = [&](const TrackedFrame& tracked) {
    const DistrustReason reason = bounds.rejection_reason(place_of(tracked, query), query.reach);
    if (reason != DistrustReason::none) result.refused = reason;
    return reason != DistrustReason::none;
  };
  const Pose camera_from_body = inverse(rig.body_from_camera);
  if (hint) {
    filter.is_excluded = [&map, &camera_from_body, around = surroundings_of(*hint)](KeyframeId id) {
      return !is_near(around, inverse(map.keyframe_header(id)->camera_from_world) * camera_from_body);
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

PlaceSearch search_place(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options) {
  const auto [found, refused] = localise_in(offline, query, options);
  PlaceSearch search{query.frame.time, query.rig, std::nullopt, refused};
  for (const TrackedFrame& place : found.places_found) search.places.push_back(place.camera_from_world);
  if (!found.tracked) return search;
  const MapGraph nothing_online(Origin::online);
  const double depth = median_depth(*found.tracked, MapView(&offline.map(), nothing_online));
  const ScratchVector<PointId> around =
      local_points(MapView(&offline.map(), nothing_online), found.tracked->reference, kKeyframesOfPlace);
  const ScratchVector<PointId> nearby =
      points_of_place(offline, keyframes_of_place(offline, found.tracked->camera_from_world));
  PlaceView view = view_of_place({offline.map(),
                                  query.rig,
                                  query.frame,
                                  *found.tracked,
                                  nearby,
                                  around,
                                  query.hidden,
                                  offline.tags(),
                                  {},
                                  {},
                                  offline.cell_unit()});
  search.found = FoundPlace{found.tracked->camera_from_world, depth, std::move(view)};
  search.refused = DistrustReason::none;
  return search;
}

}  // namespace byre
