#include "byre/localisation/place_search.h"

#include "byre/features/descriptor.h"
#include "byre/localisation/place_hypothesis.h"
#include "byre/localisation/standing_hint.h"
#include "byre/slam/body_pose.h"
#include "byre/slam/keyframes.h"

#include <algorithm>
#include <array>
#include <tuple>

namespace byre {
namespace {

PlaceToJudge place_of(const TrackedFrame& tracked, const SoughtFrame& sought) {
  const Rig& rig = sought.rig;
  return {sought.frame.time, body_pose(rig, tracked.camera_from_world),
          move_covariance(tracked.match_covariance, rig.body_from_camera)};
}

constexpr double kCellOfShifts = 0.5;  // metres

// A point elsewhere that looks like one that is seen.
struct Vote {
  std::array<int, 3> cell{};                        // cell of the shift
  std::size_t seen = 0;                             // index of the point that is seen
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // metres, from that point to the one elsewhere
};

std::vector<Vote> votes_of(const Map& map, std::span<const PointId> seen) {
  constexpr int kMostBits = 55;           // between descriptors
  constexpr double kLeastShift = 1.0;     // metres
  constexpr double kLargestShift = 30.0;  // metres, bounds the time
  std::vector<const MapPoint*> points;
  for (const PointId id : seen) points.push_back(map.find_point(id));
  std::vector<Vote> votes;
  for (const PointId id : map.point_ids()) {
    const MapPoint& other = *map.find_point(id);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (hamming_distance(points[i]->descriptor, other.descriptor) > kMostBits) continue;
      const Eigen::Vector3d shift = other.position_in_world - points[i]->position_in_world;
      if (shift.norm() < kLeastShift || shift.norm() > kLargestShift) continue;
      const Eigen::Vector3i cell = (shift / kCellOfShifts).array().round().cast<int>();
      votes.push_back({{cell.x(), cell.y(), cell.z()}, i, shift});
    }
  }
  std::ranges::sort(votes, {}, [](const Vote& vote) { return std::tie(vote.cell, vote.seen); });
  return votes;
}

// The votes of the cell with most seen points, one for each point.
std::vector<Vote> most_agreeing(std::span<const Vote> votes) {
  std::vector<Vote> most, cell;
  for (const Vote& vote : votes) {
    if (!cell.empty() && cell.front().cell != vote.cell) cell.clear();
    if (cell.empty() || cell.back().seen != vote.seen) cell.push_back(vote);
    if (cell.size() > most.size()) most = cell;
  }
  return most;
}

// What is seen from near a hint may have been mapped from farther back, and at an angle.
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
  const PlaceView view =
      view_of_place({offline, sought.rig, sought.frame, *found.tracked, nearby, around, sought.hidden});
  search.found = FoundPlace{found.tracked->camera_from_world, depth, log_odds_of(view)};
  search.refused = Doubt::none;
  return search;
}

std::vector<Eigen::Vector3d> shifts_to_places_alike(const OfflineMap& offline, const Pose& camera_from_place) {
  constexpr std::size_t kMostPlaces = 4;
  constexpr std::size_t kMinPoints = 8;
  constexpr std::size_t kMostPoints = 300;  // bounds the time
  const ReusedVector<PointId> points = points_of_place(offline, keyframes_of_place(offline, camera_from_place));
  std::vector<PointId> seen;
  const std::size_t step = points.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < points.size(); i += step) seen.push_back(points[i]);
  std::vector<Vote> votes = votes_of(offline.map(), seen);
  std::vector<Eigen::Vector3d> alike;
  while (alike.size() < kMostPlaces) {
    const std::vector<Vote> most = most_agreeing(votes);
    if (most.size() < kMinPoints) break;
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    for (const Vote& vote : most) shift += vote.shift / static_cast<double>(most.size());
    alike.push_back(shift);
    std::erase_if(votes, [&](const Vote& vote) { return (vote.shift - shift).norm() <= 2.0 * kCellOfShifts; });
  }
  return alike;
}

}  // namespace byre
