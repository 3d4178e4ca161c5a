#include "byre/slam/loops/loop_closing.h"

#include "byre/geometry/median.h"
#include "byre/slam/tracking/keyframes.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

namespace byre {
namespace {

struct LogRatio {
  double value = 0.0;
  double sigma = 0.0;
};

// Relative variance of the depth.
double relative_depth_variance(const MapPoint& point, const Pose& camera_from_world, double depth) {
  const Eigen::RowVector3d forward_in_world = camera_from_world.rotation.toRotationMatrix().row(2);
  return forward_in_world.dot(point.covariance * forward_in_world.transpose()) / (depth * depth);
}

std::vector<LogRatio> log_ratios(std::span<const DepthPair> pairs) {
  std::vector<LogRatio> ratios;
  for (const DepthPair& pair : pairs) ratios.push_back({std::log(pair.older / pair.newer), pair.sigma});
  return ratios;
}

// Robust spread of the ratios around a centre, in their own sigmas; at least 1.
double spread_about(double centre, const std::vector<LogRatio>& ratios) {
  std::vector<double> errors;
  for (const LogRatio& ratio : ratios) errors.push_back(std::abs(ratio.value - centre) / ratio.sigma);
  return robust_scale(std::move(errors));
}

constexpr PlaceQueryOptions kLoopPlaces{.max_candidates = 3, .group_size = 10, .min_score_share = 0.6f};
// Independent of the options for relocalisation: a wrong loop spoils the map.
constexpr LocaliseOptions kStrictness{};
constexpr float kMinScoreShare = 0.5f;   // similarity of a place, share of that of a covisible neighbour
constexpr double kMaxDriftTurn = 0.2;    // radians of drift
constexpr double kMaxDriftDepths = 0.1;  // median depths of drift; replaces max_drift without stereo

// The newest keyframe, those that share points with it, and those that share points with the nearest of these.
std::set<KeyframeId> surroundings_of(const MapGraph& map, KeyframeId id) {
  constexpr int kNearest = 15;
  std::set<KeyframeId> surroundings = {id};
  for (const Covisible& neighbour : map.covisible_keyframes(id)) surroundings.insert(neighbour.keyframe);
  for (const Covisible& neighbour : map.covisible_keyframes(id, kNearest)) {
    for (const Covisible& next : map.covisible_keyframes(neighbour.keyframe)) surroundings.insert(next.keyframe);
  }
  return surroundings;
}

// Similarity of neighbouring views around a keyframe.
float usual_similarity(const MapGraph& map, const PlaceIndex& index, KeyframeId id, const BagOfWords& bag) {
  constexpr int kNeighbours = 5;
  float best = 0.0f;
  for (const Covisible& neighbour : map.covisible_keyframes(id, kNeighbours)) {
    const Keyframe& keyframe = *map.find_keyframe(neighbour.keyframe);
    best = std::max(best, similarity(bag, index.vocabulary().bag_of(keyframe.words)));
  }
  return best;
}

// Places that look as much like the keyframe as its neighbours do.
std::vector<PlaceCandidate> similar_places(const MapView& view, const PlaceIndex& index, KeyframeId id,
                                           std::span<const Word> words,
                                           const std::function<bool(KeyframeId)>& is_excluded) {
  const MapGraph& map = view.online();
  std::vector<PlaceCandidate> places = find_places(index, view, words, kLoopPlaces, is_excluded);
  if (places.empty()) return places;
  const float usual = usual_similarity(map, index, id, index.vocabulary().bag_of(words));
  std::erase_if(places, [&](const PlaceCandidate& place) { return place.score < kMinScoreShare * usual; });
  return places;
}

std::vector<PlaceCandidate> find_old_places(const MapView& view, const PlaceIndex& index, KeyframeId id,
                                            std::span<const Word> words, const LoopOptions& options) {
  const std::set<KeyframeId> surroundings = surroundings_of(view.online(), id);
  return similar_places(view, index, id, words, [&](KeyframeId other) {
    return other.number + options.min_gap > id.number || surroundings.contains(other);
  });
}

// Path of the camera between two keyframes, metres.
double path_between(const MapGraph& map, KeyframeId from, KeyframeId to) {
  double length = 0.0;
  std::optional<Eigen::Vector3d> last;
  for (std::uint32_t number = from.number; number <= to.number; ++number) {
    const Keyframe* const keyframe = map.find_keyframe({map.origin(), number});
    if (keyframe == nullptr) continue;
    const Eigen::Vector3d camera_in_world = inverse(keyframe->camera_from_world).translation;
    if (last) length += (camera_in_world - *last).norm();
    last = camera_in_world;
  }
  return length;
}

// Motion of the camera by the drift, metres and radians.
struct CameraShift {
  double distance = 0.0;
  double turn = 0.0;
};

CameraShift camera_shift(const Pose& camera_from_world, const Similarity& old_from_new) {
  const Eigen::Vector3d camera_in_world = inverse(camera_from_world).translation;
  return {(old_from_new * camera_in_world - camera_in_world).norm(),
          rotation_log(old_from_new.target_from_source.rotation).norm()};
}

bool is_plausible(const LoopHypothesis& hypothesis, const MapGraph& map, const LoopOptions& options) {
  const Keyframe& keyframe = *map.find_keyframe(hypothesis.keyframe);
  const CameraShift shift = camera_shift(keyframe.camera_from_world, drift_of(hypothesis));
  const double path = path_between(map, hypothesis.place, hypothesis.keyframe);
  const double scale_drift = std::abs(std::log(hypothesis.scale));
  const double on_top =
      rig_of(map, keyframe).is_stereo() ? options.max_drift : kMaxDriftDepths * hypothesis.median_depth;
  return shift.turn <= kMaxDriftTurn && scale_drift <= options.max_scale_drift &&
         shift.distance <= on_top + (options.max_drift_share + scale_drift) * path;
}

bool is_same_pose(const TrackedFrame& tracked, const Pose& predicted_camera_from_old, double max_disagreement,
                  const MapGraph& map) {
  const Pose motion = tracked.camera_from_world * inverse(predicted_camera_from_old);
  return motion.translation.norm() <= max_disagreement * median_depth(tracked, map) &&
         rotation_log(motion.rotation).norm() <= max_disagreement;
}

// Drift between the poses of a camera in the newer and in the older part.
Pose drift_between(const Pose& camera_from_old, const Pose& camera_from_new, double scale) {
  return inverse(camera_from_old) * scale_lengths(camera_from_new, scale);
}

// Stereo measures the scale. Otherwise points in both parts determine it, at best as precisely as the camera's position
// in the older part is known.
std::optional<ScaleDrift> find_scale_drift(const MapGraph& map, const Keyframe& keyframe,
                                           const TrackedFrame& in_older_part, double depth,
                                           const LoopOptions& options) {
  if (rig_of(map, keyframe).is_stereo()) return ScaleDrift{};
  auto drift = estimate_scale_drift(depth_pairs(map, keyframe, in_older_part), options.min_scale_points);
  if (!drift) return std::nullopt;
  drift->sigma = std::hypot(drift->sigma, std::sqrt(in_older_part.match_covariance(2, 2)) / depth);
  if (drift->sigma > options.max_scale_sigma) return std::nullopt;
  return drift;
}

// Localises a keyframe at the best of these places. begun: hypothesis with the test to continue.
std::optional<LoopHypothesis> localise_at_places(const MapView& view, const PlaceIndex& index, KeyframeId id,
                                                 std::span<const Word> words, const std::vector<PlaceCandidate>& places,
                                                 LoopHypothesis begun, const LoopOptions& options) {
  const MapGraph& map = view.online();
  const Keyframe& keyframe = *map.find_keyframe(id);
  const Rig& rig = rig_of(map, keyframe);
  const Localisation found = localise_at(keyframe.frame, words, rig, view, index.vocabulary(), places, kStrictness);
  if (!found.tracked) return std::nullopt;

  LoopHypothesis hypothesis = std::move(begun);
  hypothesis.keyframe = id;
  hypothesis.place = found.tracked->reference;
  hypothesis.covariance = found.tracked->match_covariance;
  const double depth = median_depth(*found.tracked, view);
  if (hypothesis.median_depth == 0.0) hypothesis.median_depth = depth;
  const auto drift = find_scale_drift(map, keyframe, *found.tracked, depth, options);
  if (!drift) return std::nullopt;
  hypothesis.scale = drift->old_per_new;
  hypothesis.scale_sigma = drift->sigma;
  hypothesis.old_from_new =
      drift_between(found.tracked->camera_from_world, keyframe.camera_from_world, hypothesis.scale);
  hypothesis.test.observe(view_of_map(keyframe.frame, *found.tracked, hypothesis.median_depth, rig, map), false);
  return hypothesis;
}

}  // namespace

PlaceView view_of_map(const Frame& frame, const TrackedFrame& tracked, double median_depth, const Rig& rig,
                      const MapGraph& map) {
  constexpr int kKeyframesNearby = 3;
  constexpr double kDepth = 5.0;  // metres
  const ScratchVector<PointId> nearby = local_points(map, tracked.reference, kKeyframesNearby);
  const ScratchVector<PointId> around = local_points(map, tracked.reference, kKeyframesOfPlace);
  const double share = median_depth / kDepth;
  const double metre = rig.is_stereo() ? std::min(1.0, share) : share;
  return view_of_place({map, rig, frame, tracked, nearby, around, {}, {}, {}, {}, metre});
}

std::vector<DepthPair> depth_pairs(const MapGraph& map, const Keyframe& keyframe, const TrackedFrame& in_older_part) {
  constexpr double kMinVariance = 0.005 * 0.005;  // lower bound, whatever the covariance
  std::vector<DepthPair> pairs;
  for (const TrackedFeature& feature : in_older_part.features) {
    const auto& own = keyframe.sightings[static_cast<std::size_t>(feature.feature)].point;
    const MapPoint* const newer = own && *own != feature.point ? map.find_point(*own) : nullptr;
    const MapPoint* const older = map.find_point(feature.point);
    if (newer == nullptr || older == nullptr) continue;
    const double newer_depth = (keyframe.camera_from_world * newer->position_in_world).z();
    const double older_depth = (in_older_part.camera_from_world * older->position_in_world).z();
    if (newer_depth <= 0.0 || older_depth <= 0.0) continue;
    const double variance = relative_depth_variance(*newer, keyframe.camera_from_world, newer_depth) +
                            relative_depth_variance(*older, in_older_part.camera_from_world, older_depth);
    pairs.push_back({newer_depth, older_depth, std::sqrt(variance + kMinVariance)});
  }
  return pairs;
}

std::optional<ScaleDrift> estimate_scale_drift(std::span<const DepthPair> pairs, int min_pairs) {
  constexpr double kMaxError = 3.0;  // spreads
  std::vector<LogRatio> ratios = log_ratios(pairs);
  if (ratios.empty()) return std::nullopt;
  std::vector<double> values;
  for (const LogRatio& ratio : ratios) values.push_back(ratio.value);
  const double centre = median(std::move(values));
  const double spread = spread_about(centre, ratios);
  std::erase_if(
      ratios, [&](const LogRatio& ratio) { return std::abs(ratio.value - centre) > kMaxError * spread * ratio.sigma; });
  if (static_cast<int>(ratios.size()) < min_pairs) return std::nullopt;

  double weights = 0.0, weighted = 0.0;
  for (const LogRatio& ratio : ratios) {
    const double weight = 1.0 / (ratio.sigma * ratio.sigma);
    weights += weight;
    weighted += weight * ratio.value;
  }
  return ScaleDrift{std::exp(weighted / weights), spread / std::sqrt(weights)};
}

std::optional<LoopHypothesis> find_loop(const MapGraph& map, const PlaceIndex& index, KeyframeId newest,
                                        const LoopOptions& options) {
  const Keyframe* const keyframe = map.find_keyframe(newest);
  if (keyframe == nullptr) return std::nullopt;
  return find_loop_by_words(map, index, newest, keyframe->words, options);
}

std::optional<LoopHypothesis> find_loop_by_words(const MapGraph& map, const PlaceIndex& index, KeyframeId newest,
                                                 std::span<const Word> words, const LoopOptions& options) {
  const Keyframe* const keyframe = map.find_keyframe(newest);
  if (keyframe == nullptr || words.empty()) return std::nullopt;
  const MapView view(nullptr, map);
  const std::vector<PlaceCandidate> places = find_old_places(view, index, newest, words, options);
  if (places.empty()) return std::nullopt;
  const auto hypothesis = localise_at_places(view, index, newest, words, places, {}, options);
  if (!hypothesis || !is_plausible(*hypothesis, map, options)) return std::nullopt;
  return hypothesis;
}

std::optional<LoopHypothesis> find_join(const MapGraph& map, const PlaceIndex& index, KeyframeId separate,
                                        const std::function<bool(KeyframeId)>& is_in_map, const LoopHypothesis* known,
                                        const LoopOptions& options) {
  constexpr int kConfirmations = 4;          // tracked keyframes
  constexpr double kMaxDisagreement = 0.03;  // see LoopHypothesis; a young submap is less precise than the map
  const Keyframe* const keyframe = map.find_keyframe(separate);
  if (keyframe == nullptr || keyframe->words.empty()) return std::nullopt;
  const MapView view(nullptr, map);
  const auto is_excluded = [&](KeyframeId id) { return !is_in_map(id); };
  const std::vector<PlaceCandidate> places = similar_places(view, index, separate, keyframe->words, is_excluded);
  if (places.empty()) return std::nullopt;
  LoopHypothesis begun;
  begun.max_disagreement = kMaxDisagreement;
  begun.test = known != nullptr ? known->test : PlaceHypothesis(kLogOddsOfKidnapping, kConfirmations);
  begun.median_depth = known != nullptr ? known->median_depth : 0.0;
  return localise_at_places(view, index, separate, keyframe->words, places, std::move(begun), options);
}

bool agree(const LoopHypothesis& one, const LoopHypothesis& other, const MapGraph& map, const LoopOptions& options) {
  constexpr double kMaxTurn = 0.1;   // radians
  constexpr double kMaxScale = 0.1;  // natural logarithm
  const Pose& camera = map.find_keyframe(other.keyframe)->camera_from_world;
  const Pose apart = move_camera(drift_of(one), camera) * inverse(move_camera(drift_of(other), camera));
  const double scale_drift = std::abs(std::log(one.scale / other.scale));
  const auto [first, last] = std::minmax(one.keyframe, other.keyframe);
  const double path = other.scale * path_between(map, first, last);
  return rotation_log(apart.rotation).norm() <= kMaxTurn && scale_drift <= kMaxScale &&
         apart.translation.norm() <=
             kMaxDriftDepths * other.median_depth + (options.max_drift_share + scale_drift) * path;
}

LoopHypothesis check_loop(const LoopHypothesis& hypothesis, const Frame& frame, const Pose& camera_from_world,
                          const Rig& rig, const MapGraph& map) {
  LoopHypothesis checked = hypothesis;
  TrackedFrame there;
  there.camera_from_world = move_camera(drift_of(hypothesis), camera_from_world);
  there.reference = hypothesis.place;
  const auto tracked =
      track(frame, there.camera_from_world, rig, map, local_points(map, hypothesis.place, kKeyframesOfPlace), {});
  const bool agrees = tracked && is_same_pose(*tracked, there.camera_from_world, hypothesis.max_disagreement, map);
  if (agrees) there = *tracked;
  checked.test.observe(view_of_map(frame, there, hypothesis.median_depth, rig, map), agrees);
  if (!agrees) {
    ++checked.untracked;
    return checked;
  }
  checked.place = there.reference;
  checked.old_from_new = drift_between(there.camera_from_world, camera_from_world, hypothesis.scale);
  checked.covariance = there.match_covariance;
  return checked;
}

bool is_refuted(const LoopHypothesis& hypothesis) {
  constexpr int kMaxUntracked = 3;  // frames
  return hypothesis.test.is_rejected() || hypothesis.untracked >= kMaxUntracked;
}

std::optional<LoopEdge> edge_of(const LoopHypothesis& hypothesis, const MapGraph& map) {
  const Keyframe* const keyframe = map.find_keyframe(hypothesis.keyframe);
  const Keyframe* const place = map.find_keyframe(hypothesis.place);
  if (keyframe == nullptr || place == nullptr) return std::nullopt;
  const Pose camera_from_old = move_camera(drift_of(hypothesis), keyframe->camera_from_world);
  const double new_per_old = 1.0 / hypothesis.scale;
  return LoopEdge{hypothesis.keyframe,
                  hypothesis.place,
                  scale_lengths(camera_from_old * inverse(place->camera_from_world), new_per_old),
                  scale_lengths(hypothesis.covariance, new_per_old),
                  new_per_old,
                  hypothesis.scale_sigma};
}

double apparent_drift(const LoopHypothesis& hypothesis, const MapGraph& map) {
  const Keyframe* const keyframe = map.find_keyframe(hypothesis.keyframe);
  if (keyframe == nullptr) return 0.0;
  const CameraShift shift = camera_shift(keyframe->camera_from_world, drift_of(hypothesis));
  const double shift_share = shift.distance / std::max(1e-3, hypothesis.median_depth);
  return rig_of(map, *keyframe).focal * (shift.turn + shift_share + std::abs(std::log(hypothesis.scale)));
}

}  // namespace byre
