#include "byre/slam/places/localisation.h"

#include "byre/base/enum_names.h"
#include "byre/features/descriptor.h"
#include "byre/geometry/absolute_pose.h"
#include "byre/geometry/decompositions.h"
#include "byre/geometry/tag_pose.h"
#include "byre/slam/places/place_view.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace byre {
namespace {

struct NodeFeature {
  std::uint32_t node = 0;
  int feature = 0;
  auto operator<=>(const NodeFeature&) const = default;
};

using NodeFeatures = std::vector<NodeFeature>;   // features in ascending order of their nodes
using NodeRange = std::span<const NodeFeature>;  // features of one node

template <typename Choose>
NodeFeatures features_by_node(std::span<const Word> words, const Vocabulary& vocabulary, int levels_up, Choose choose) {
  NodeFeatures result;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (choose(i)) result.push_back({vocabulary.node_above(words[i], levels_up), static_cast<int>(i)});
  }
  std::sort(result.begin(), result.end());
  return result;
}

// Calls visit(range of first, range of second) for each node with features of both.
template <typename Visitor>
void visit_shared_nodes(const NodeFeatures& first, const NodeFeatures& second, Visitor visit) {
  const auto end_of_node = [](auto begin, auto end) {
    return std::find_if(begin, end, [&](const NodeFeature& entry) { return entry.node != begin->node; });
  };
  auto a = first.begin(), b = second.begin();
  while (a != first.end() && b != second.end()) {
    const auto a_end = end_of_node(a, first.end()), b_end = end_of_node(b, second.end());
    if (a->node == b->node) visit(NodeRange(a, a_end), NodeRange(b, b_end));
    const bool advance_a = a->node <= b->node, advance_b = b->node <= a->node;
    if (advance_a) a = a_end;
    if (advance_b) b = b_end;
  }
}

struct Nearest {
  int feature = -1;
  int distance = std::numeric_limits<int>::max();
  int second_distance = std::numeric_limits<int>::max();
};

Nearest nearest_of(const Descriptor& descriptor, const Features& features, NodeRange candidates) {
  Nearest nearest;
  for (const NodeFeature& candidate : candidates) {
    const int distance = hamming_distance(descriptor, features.descriptor(candidate.feature));
    if (distance < nearest.distance) {
      nearest = {candidate.feature, distance, nearest.distance};
    } else if (distance < nearest.second_distance) {
      nearest.second_distance = distance;
    }
  }
  return nearest;
}

bool is_distinct(const Nearest& nearest, const PlaceMatchOptions& options) {
  return nearest.distance <= options.max_distance &&
         static_cast<float>(nearest.distance) < options.max_ratio * static_cast<float>(nearest.second_distance);
}

// False for a point of an offline map that is not in the view.
bool shows_known_point(const MapView& map, const Sighting& sighting) {
  return sighting.point && map.find_point(*sighting.point) != nullptr;
}

// At most one match for each feature and each point: the most similar.
std::vector<PointMatch> most_similar(std::vector<PointMatch> matches) {
  const auto by_similarity = [](const PointMatch& a, const PointMatch& b) {
    return std::tie(a.distance, a.feature, a.point) < std::tie(b.distance, b.feature, b.point);
  };
  const auto keep_first_of_each = [&](auto key) {
    std::ranges::sort(matches, by_similarity);
    std::ranges::stable_sort(matches, {}, key);
    const auto is_repeated = [&](const PointMatch& a, const PointMatch& b) { return a.*key == b.*key; };
    matches.erase(std::unique(matches.begin(), matches.end(), is_repeated), matches.end());
  };
  keep_first_of_each(&PointMatch::point);
  keep_first_of_each(&PointMatch::feature);
  return matches;
}

constexpr int kMinFeatures = 50;        // corners in a frame
constexpr int kMinMatches = 10;         // matches by words
constexpr int kMinPoseInliers = 8;      // inliers of a first pose
constexpr int kMaxDraws = 2000;         // RANSAC iterations
constexpr double kMaxMatchError = 6.0;  // pixels, largest error of an inlier of a first pose
// Search around a first pose: default options, since it is no motion prediction.
TrackOptions around_first_pose(const LocaliseOptions& options) {
  TrackOptions around;
  around.hidden = options.hidden;
  return around;
}

using Failure = LocalisationFailure;

// Inputs common to all places.
struct FrameQuery {
  const Frame& frame;
  const Rig& rig;
  const MapView& map;
  const Vocabulary& vocabulary;
  std::span<const Word> words;
  const LocaliseOptions& options;
  const PlaceFilter& filter;
};

Localisation failed(Failure failure, int matches, std::size_t inliers) {
  return {std::nullopt, {}, failure, 0, matches, static_cast<int>(inliers)};
}

PointSighting sighting_of(const FrameQuery& query, const PointMatch& match) {
  const Keypoint& keypoint = query.frame.features->keypoint(match.feature);
  PointSighting sighting{query.map.find_point(match.point)->position_in_world, keypoint.pixel.cast<double>()};
  if (keypoint.has_disparity()) sighting.disparity = keypoint.disparity;
  return sighting;
}

std::optional<AbsolutePose> pose_from_matches(const FrameQuery& query, const std::vector<PointMatch>& matches) {
  std::vector<PointSighting> sightings;
  sightings.reserve(matches.size());
  for (const PointMatch& match : matches) sightings.push_back(sighting_of(query, match));
  const RansacOptions ransac{
      .max_iterations = kMaxDraws, .confidence = 0.999, .max_error = kMaxMatchError, .seed = query.options.seed};
  return estimate_absolute_pose(sightings, query.rig, ransac);
}

// Matches points around a first pose, then points around the keyframe that shares most of these.
std::optional<TrackedFrame> refine(const FrameQuery& query, const Pose& camera_from_world, KeyframeId place) {
  const auto track_near = [&](const Pose& predicted, KeyframeId reference) {
    return track(query.frame, predicted, query.rig, query.map, local_points(query.map, reference, kKeyframesOfPlace),
                 around_first_pose(query.options));
  };
  const std::optional<TrackedFrame> first = track_near(camera_from_world, place);
  if (!first || first->reference == place) return first;
  const std::optional<TrackedFrame> second = track_near(first->camera_from_world, first->reference);
  return second && second->features.size() > first->features.size() ? second : first;
}

// The refined pose if it is reliable. agreeing: inliers of the pose before.
Localisation checked(const FrameQuery& query, const std::optional<TrackedFrame>& tracked, int match_count,
                     int agreeing) {
  if (!tracked) return failed(Failure::too_few_inliers, match_count, static_cast<std::size_t>(agreeing));
  const Failure doubt = rejection_reason(*tracked, query.rig, query.map, query.options);
  if (doubt != Failure::none) return failed(doubt, match_count, tracked->features.size());
  if (query.filter.is_impossible && query.filter.is_impossible(*tracked)) {
    return failed(Failure::impossible, match_count, tracked->features.size());
  }
  return {tracked, {}, Failure::none, 0, match_count, static_cast<int>(tracked->features.size())};
}

std::optional<FocalEvidence> focal_evidence(const FrameQuery& query, const AbsolutePose& pose,
                                            const std::vector<PointMatch>& matches) {
  constexpr int kMinAgreeing = 12;
  constexpr double kMaxError = 30.0;  // pixels; no prediction bounds the errors of word matches
  if (pose.inlier_count < kMinAgreeing) return std::nullopt;
  std::vector<PoseObservation> seen;
  for (const PointMatch& match : matches) {
    const Keypoint& keypoint = query.frame.features->keypoint(match.feature);
    const StereoPixel measured(keypoint.pixel.x(), keypoint.pixel.y(), keypoint.disparity);
    const double disparity_sigma = keypoint.has_disparity() ? keypoint.disparity_sigma : -1.0;
    seen.push_back(pose_observation(*query.map.find_point(match.point), measured, 1.0, disparity_sigma));
  }
  const auto refined = refine_pose(pose.camera_from_world, query.rig, seen, {});
  if (!refined) return std::nullopt;
  return compare_focal_lengths(refined->camera_from_world, query.rig, seen, kMaxError);
}

Localisation try_place(const PlaceCandidate& place, const FrameQuery& query) {
  const std::vector<PointMatch> matches =
      match_place(*query.frame.features, query.words, query.map, place.group, query.vocabulary, {});
  const int match_count = static_cast<int>(matches.size());
  if (match_count < kMinMatches) return failed(Failure::too_few_matches, match_count, matches.size());

  const std::optional<AbsolutePose> pose = pose_from_matches(query, matches);
  const int agreeing = pose ? pose->inlier_count : 0;
  if (agreeing < kMinPoseInliers) {
    return failed(Failure::geometry_disagrees, match_count, static_cast<std::size_t>(agreeing));
  }
  Localisation result = checked(query, refine(query, pose->camera_from_world, place.keyframe), match_count, agreeing);
  if (!result.tracked) result.focal = focal_evidence(query, *pose, matches);
  return result;
}

// Keyframes with views from near a pose, nearest first, by the distance in metres plus the angle in radians.
std::vector<KeyframeId> keyframes_near(const MapGraph& map, const Pose& camera_from_world) {
  constexpr double kFarthest = 8.0;
  std::vector<std::pair<double, KeyframeId>> near;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Pose apart = map.keyframe_header(id)->camera_from_world * inverse(camera_from_world);
    const double distance = apart.translation.norm() + rotation_log(apart.rotation).norm();
    if (distance < kFarthest) near.emplace_back(distance, id);
  }
  std::ranges::sort(near);
  std::vector<KeyframeId> ids;
  for (const auto& [distance, id] : near) {
    if (std::ssize(ids) < kPlacesTried.group_size) ids.push_back(id);
  }
  return ids;
}

// Map points around the pose by a tag, else words of the keyframes around it: a pose by one tag may be decimetres off.
Localisation try_tag(const Pose& camera_from_world, const FrameQuery& query) {
  std::vector<KeyframeId> keyframes = keyframes_near(*query.map.offline(), camera_from_world);
  if (query.filter.is_excluded) std::erase_if(keyframes, query.filter.is_excluded);
  if (keyframes.empty()) return failed(Failure::no_similar_keyframe, 0, 0);
  const Localisation there = checked(query, refine(query, camera_from_world, keyframes.front()), 0, 0);
  if (there.tracked) return there;
  return try_place({keyframes.front(), 0.0F, 0.0F, keyframes}, query);
}

// Whether the tags in the frame are where the pose predicts them.
bool agrees_with_tags(const TrackedFrame& place, const FrameQuery& query) {
  const auto tags = tags_in_view(query.frame, place.camera_from_world, query.rig, query.options.tags);
  return !tags.empty() && std::ranges::all_of(tags, &TagInView::agrees);
}

// Whether at most one of two poses can be right.
bool contradict(const TrackedFrame& one, const TrackedFrame& other, const MapView& map) {
  constexpr double kMaxShift = 0.05;  // share of the median depth
  constexpr double kMaxTurn = 0.05;   // radians
  const Pose motion = one.camera_from_world * inverse(other.camera_from_world);
  return motion.translation.norm() > kMaxShift * median_depth(one, map) ||
         rotation_log(motion.rotation).norm() > kMaxTurn;
}

// Attempts with a pose rank above those without, by inliers; the others by progress.
std::pair<bool, int> rank_of(const Localisation& attempt) {
  return {attempt.tracked.has_value(), attempt.tracked ? attempt.inliers : static_cast<int>(attempt.failure)};
}

// Places that contradict each other, most inliers first; the first one of places that agree.
std::vector<TrackedFrame> distinct_places(std::vector<TrackedFrame> found, const MapView& map) {
  std::ranges::stable_sort(found, std::greater{}, [](const TrackedFrame& place) { return place.features.size(); });
  std::vector<TrackedFrame> places;
  for (TrackedFrame& place : found) {
    const bool is_known =
        std::ranges::any_of(places, [&](const TrackedFrame& better) { return !contradict(better, place, map); });
    if (!is_known) places.push_back(std::move(place));
  }
  return places;
}

}  // namespace

std::vector<PointMatch> match_place(const Features& frame, std::span<const Word> words, const MapView& map,
                                    std::span<const KeyframeId> keyframes, const Vocabulary& vocabulary,
                                    const PlaceMatchOptions& options) {
  const NodeFeatures of_frame =
      features_by_node(words, vocabulary, options.levels_up, [](std::size_t) { return true; });
  std::vector<PointMatch> matches;
  for (const KeyframeId id : keyframes) {
    const Keyframe* const keyframe = map.find_keyframe(id);
    if (keyframe == nullptr) continue;
    const Features& features = *keyframe->frame.features;
    const NodeFeatures of_keyframe =
        features_by_node(keyframe->words, vocabulary, options.levels_up,
                         [&](std::size_t i) { return shows_known_point(map, keyframe->sightings[i]); });
    visit_shared_nodes(of_keyframe, of_frame, [&](NodeRange of_points, NodeRange candidates) {
      for (const NodeFeature& seen : of_points) {
        const Nearest nearest = nearest_of(features.descriptor(seen.feature), frame, candidates);
        if (!is_distinct(nearest, options)) continue;
        const Nearest back = nearest_of(frame.descriptor(nearest.feature), features, of_points);
        if (back.feature != seen.feature) continue;
        const PointId point = *keyframe->sightings[static_cast<std::size_t>(seen.feature)].point;
        matches.push_back({nearest.feature, point, nearest.distance});
      }
    });
  }
  return most_similar(std::move(matches));
}

std::string_view to_string(LocalisationFailure failure) {
  return name_among<Failure::ambiguous>(
      {"none", "too few features", "no similar keyframe", "too few matches", "geometry does not agree",
       "too few inliers", "inliers are clustered", "pose is uncertain", "place is impossible",
       "too few expected points", "two places fit"},
      failure);
}

double spread_of(std::span<const TrackedFeature> features, const Rig& rig) {
  if (features.empty()) return 0.0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  for (const TrackedFeature& feature : features) mean += feature.pixel.cast<double>();
  mean /= static_cast<double>(features.size());
  Eigen::Matrix2d covariance = Eigen::Matrix2d::Zero();
  for (const TrackedFeature& feature : features) {
    const Eigen::Vector2d offset = feature.pixel.cast<double>() - mean;
    covariance += offset * offset.transpose();
  }
  covariance /= static_cast<double>(features.size());
  return std::sqrt(std::max(0.0, symmetric_eigenvalues(covariance)[0])) / std::hypot(rig.width, rig.height);
}

LocalisationFailure rejection_reason(const TrackedFrame& tracked, const Rig& rig, const MapView& map,
                                     const LocaliseOptions& options) {
  if (static_cast<int>(tracked.features.size()) < options.min_inliers) return Failure::too_few_inliers;
  if (spread_of(tracked.features, rig) < options.min_spread) return Failure::clustered;
  const double position_sigma = std::sqrt(position_variance(tracked.match_covariance));
  const double rotation_sigma = std::sqrt(rotation_variance(tracked.match_covariance));
  const bool determined = position_sigma <= options.max_position_sigma * median_depth(tracked, map) &&
                          rotation_sigma <= options.max_rotation_sigma;
  return determined ? Failure::none : Failure::uncertain;
}

Localisation localise(const Frame& frame, const Rig& rig, const MapView& map, const PlaceIndex& index,
                      const LocaliseOptions& options, const PlaceFilter& filter) {
  if (frame.features->size() < kMinFeatures) return failed(Failure::too_few_features, 0, 0);
  const std::vector<Word> words = index.vocabulary().words_of(*frame.features);
  const std::vector<PlaceCandidate> places = find_places(index, map, words, kPlacesTried, filter.is_excluded);
  return localise_at(frame, words, rig, map, index.vocabulary(), places, options, filter);
}

Localisation localise_at(const Frame& frame, std::span<const Word> words, const Rig& rig, const MapView& map,
                         const Vocabulary& vocabulary, std::span<const PlaceCandidate> places,
                         const LocaliseOptions& options, const PlaceFilter& filter) {
  const FrameQuery query{frame, rig, map, vocabulary, words, options, filter};
  Localisation best = failed(Failure::no_similar_keyframe, 0, 0);
  std::vector<TrackedFrame> found;
  const auto note = [&](const Localisation& attempt) {
    if (attempt.tracked) found.push_back(*attempt.tracked);
    if (rank_of(attempt) > rank_of(best)) best = attempt;
  };
  for (const PlaceCandidate& place : places) note(try_place(place, query));
  const std::vector<Pose> by_tags =
      map.offline() != nullptr ? camera_poses_by_tags(frame, rig, options.tags) : std::vector<Pose>();
  for (const Pose& pose : by_tags) note(try_tag(pose, query));
  best.places = static_cast<int>(places.size() + by_tags.size());
  best.places_found = distinct_places(std::move(found), map);
  const auto fits_as_well = [&](const TrackedFrame& other) {
    return static_cast<double>(other.features.size()) >= kRivalShare * best.inliers;
  };
  if (best.places_found.size() < 2 || !fits_as_well(best.places_found[1])) return best;
  // Places that fit as well, those that agree with the tags first.
  const auto others = std::ranges::partition_point(best.places_found, fits_as_well);
  const auto rest = std::stable_partition(best.places_found.begin(), others,
                                          [&](const TrackedFrame& place) { return agrees_with_tags(place, query); });
  if (rest - best.places_found.begin() == 1) {
    best.tracked = best.places_found.front();
    best.inliers = static_cast<int>(best.tracked->features.size());
  } else {
    best.tracked.reset();
    best.failure = Failure::ambiguous;
  }
  return best;
}

std::vector<Pose> camera_poses_by_tags(const Frame& frame, const Rig& rig, std::span<const MappedTag> tags) {
  std::vector<Pose> poses;
  for (const TagSighting& seen : frame.tags) {
    const auto tag = std::ranges::find(tags, seen.id, &MappedTag::id);
    if (tag == tags.end()) continue;
    const TagView view{{}, rig, seen.corners};
    for (const TagEstimate& estimate : estimate_tag_pose({&view, 1}, tag->size)) {
      poses.push_back(estimate.world_from_tag * inverse(tag->map_from_tag));
    }
  }
  return poses;
}

}  // namespace byre
