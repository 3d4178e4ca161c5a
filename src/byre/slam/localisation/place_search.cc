#include "byre/slam/localisation/place_search.h"

#include "byre/slam/places/place_hypothesis.h"
#include "byre/slam/tracking/body_pose.h"
#include "byre/slam/tracking/keyframes.h"

#include <algorithm>
#include <cmath>
#include <functional>
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

// Places of a frame to try in one map; the words are those of the frame.
struct Candidates {
  std::span<const Word> words;
  std::vector<PlaceCandidate> places{};
};

// Candidates of each map. Those of all maps compete by their group scores, which depend on frame and vocabulary alone.
std::vector<Candidates> candidates_in(std::span<const std::shared_ptr<const OfflineMap>> maps,
                                      std::span<const Word> words) {
  constexpr std::size_t kLeastOfMap = 2;
  std::vector<Candidates> candidates;
  std::vector<float> scores;
  for (const auto& offline : maps) {
    candidates.push_back({words, find_places(offline->places(), offline->map(), words, kPlacesTried)});
    for (const PlaceCandidate& place : candidates.back().places) scores.push_back(place.group_score);
  }
  std::ranges::sort(scores, std::greater{});
  const std::size_t most = std::min(scores.size(), static_cast<std::size_t>(kPlacesTried.max_candidates));
  const float least = most > 0 ? std::max(scores[most - 1], kPlacesTried.min_score_share * scores.front()) : 0.0F;
  for (Candidates& of_map : candidates) {
    std::vector<PlaceCandidate>& places = of_map.places;
    while (places.size() > kLeastOfMap && places.back().group_score < least) places.pop_back();
  }
  return candidates;
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

namespace {

// candidates: nullptr: by a query of this map.
BoundedLocalisation localise_at_candidates(const OfflineMap& offline, const PlaceQuery& query,
                                           const PlaceSearchOptions& options, const Candidates* candidates) {
  const auto& [frame, rig, hint, reach, hidden] = query;
  LocaliseOptions localise_options = options.localise;
  localise_options.hidden = hidden;
  localise_options.tags = offline.tags();
  const MapView map(offline.map());
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
  found = candidates != nullptr ? localise_at(frame, candidates->words, rig, map, offline.places().vocabulary(),
                                              candidates->places, localise_options, filter)
                                : localise(frame, rig, map, offline.places(), localise_options, filter);
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

PlaceView view_at(const OfflineMap& offline, const Frame& frame, const Rig& rig, const ImageMask& hidden,
                  const TrackedFrame& tracked) {
  const ScratchVector<PointId> around = local_points(offline.map(), tracked.reference, kKeyframesOfPlace);
  const ScratchVector<PointId> nearby =
      points_of_place(offline, keyframes_of_place(offline, tracked.camera_from_world));
  return view_of_place(
      {offline.map(), rig, frame, tracked, nearby, around, hidden, offline.tags(), {}, {}, offline.cell_unit()});
}

PlaceSearch search_at_candidates(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options,
                                 const Candidates* candidates) {
  const auto [found, refused] = localise_at_candidates(offline, query, options, candidates);
  PlaceSearch search{query.frame.time, query.rig, std::nullopt, refused};
  search.focal = found.focal;
  for (const TrackedFrame& place : found.places_found) {
    search.places.push_back({place.camera_from_world, median_depth(place, offline.map()),
                             view_at(offline, query.frame, query.rig, query.hidden, place)});
  }
  if (!found.tracked) return search;
  search.found = search.places.front();
  search.refused = DistrustReason::none;
  return search;
}

}  // namespace

BoundedLocalisation localise_in(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options) {
  return localise_at_candidates(offline, query, options, nullptr);
}

PlaceSearch search_place(const OfflineMap& offline, const PlaceQuery& query, const PlaceSearchOptions& options) {
  return search_at_candidates(offline, query, options, nullptr);
}

std::vector<PlaceSearch> search_places(std::span<const std::shared_ptr<const OfflineMap>> maps, const PlaceQuery& query,
                                       const PlaceSearchOptions& options) {
  const std::vector<Word> words = maps.front()->places().vocabulary().words_of(*query.frame.features);
  const std::vector<Candidates> candidates = candidates_in(maps, words);
  std::vector<PlaceSearch> searches;
  for (std::size_t i = 0; i < maps.size(); ++i) {
    searches.push_back(search_at_candidates(*maps[i], query, options, &candidates[i]));
  }
  return searches;
}

ImageLocalisation localise_image(std::span<const OfflineMap* const> maps, const Frame& frame, const Rig& rig) {
  // Log-odds.
  const double unlikely = -std::log(10.0), much_less_likely = std::log(20.0), certain = std::log(1e4);
  constexpr double kRepetition = 0.3;  // share of the inliers
  struct LikelyPlace {
    int map = 0;
    const TrackedFrame* tracked = nullptr;
    double log_odds = 0.0;

    double inliers() const { return static_cast<double>(tracked->features.size()); }
  };
  std::vector<Localisation> attempts;  // one for each map
  for (const OfflineMap* const offline : maps) {
    LocaliseOptions options;
    options.tags = offline->tags();
    attempts.push_back(localise(frame, rig, offline->map(), offline->places(), options));
  }
  std::vector<LikelyPlace> places;
  for (int map = 0; map < std::ssize(maps); ++map) {
    for (const TrackedFrame& place : attempts[static_cast<std::size_t>(map)].places_found) {
      places.push_back(
          {map, &place, log_odds_of(view_at(*maps[static_cast<std::size_t>(map)], frame, rig, {}, place))});
    }
  }
  if (places.empty()) {
    const auto best = std::ranges::max_element(attempts, {}, &Localisation::failure);
    return {*best, static_cast<int>(best - attempts.begin())};
  }
  std::ranges::stable_sort(places, std::ranges::greater{}, &LikelyPlace::log_odds);
  const LikelyPlace& likeliest = places.front();
  ImageLocalisation result{attempts[static_cast<std::size_t>(likeliest.map)], likeliest.map};
  Localisation& found = result.found;
  found.inliers = static_cast<int>(likeliest.inliers());
  found.tracked.reset();
  // A building that repeats may do so beyond the map, where no place competes.
  const bool is_repeated = std::ranges::any_of(places.begin() + 1, places.end(), [&](const LikelyPlace& place) {
    return place.inliers() >= kRepetition * likeliest.inliers();
  });
  if (likeliest.log_odds < unlikely) {
    found.failure = LocalisationFailure::unlikely;
  } else if ((is_repeated && likeliest.log_odds < certain) ||
             (places.size() > 1 && likeliest.log_odds - places[1].log_odds < much_less_likely)) {
    found.failure = LocalisationFailure::ambiguous;
  } else {
    found.failure = LocalisationFailure::none;
    found.tracked = *likeliest.tracked;
  }
  return result;
}

}  // namespace byre
