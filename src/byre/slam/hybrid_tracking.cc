#include "byre/slam/hybrid_tracking.h"

#include "byre/geometry/median.h"
#include "byre/slam/tracking_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Two poses disagree when they see the same points farther apart than this, and than their uncertainty explains.
constexpr double kMaxApparentShift = 2.0;      // pixels
constexpr double kMaxSquaredDeviation = 30.0;  // squared sigmas, of six degrees of freedom

// What is needed at every step.
struct Query {
  const Frame& frame;
  const Rig& rig;
  const MapView& map;
  const TrackOptions& options;
};

// One value for the points of each map.
template <typename Value>
struct ByMap {
  Value offline;
  Value online;
};

ByMap<std::vector<PointId>> split(const std::vector<PointId>& candidates) {
  ByMap<std::vector<PointId>> result;
  for (const PointId id : candidates) (id.origin == Origin::offline ? result.offline : result.online).push_back(id);
  return result;
}

double median_depth(const Query& query, const std::vector<ExpectedPoint>& points, const Pose& camera_from_world) {
  std::vector<double> depths;
  depths.reserve(points.size());
  for (const ExpectedPoint& point : points) {
    depths.push_back((camera_from_world * query.map.find_point(point.id)->position_in_world).z());
  }
  return depths.empty() ? 1.0 : std::max(1e-3, median(std::move(depths)));
}

// Pixels by which two poses see a point at this depth apart.
double apparent_shift(const Pose& one, const Pose& other, double depth, const Rig& rig) {
  const Pose motion = one * inverse(other);
  return rig.focal * (rotation_log(motion.rotation).norm() + motion.translation.norm() / depth);
}

bool disagree(const PoseRefinement& one, const PoseRefinement& other, double depth, const Rig& rig) {
  if (apparent_shift(one.camera_from_world, other.camera_from_world, depth, rig) <= kMaxApparentShift) return false;
  const Vector6 deviation = log_pose(one.camera_from_world * inverse(other.camera_from_world));
  const Matrix6 covariance = one.covariance + other.covariance;
  return deviation.dot(covariance.ldlt().solve(deviation)) > kMaxSquaredDeviation;
}

// A pose that few points hold may be less certain than what is known of the drift: then it cannot correct that.
bool is_sharper_than(const DriftBound& drift, const PoseRefinement& refined) {
  constexpr double kSigmas = 3.0;
  return kSigmas * std::sqrt(refined.covariance.topLeftCorner<3, 3>().trace()) <= drift.translation;
}

std::optional<Pose> guess(const Query& query, const Pose& predicted, const std::vector<ExpectedPoint>& points,
                          float radius) {
  if (points.empty()) return std::nullopt;
  return first_pose(query.frame, predicted, query.rig, query.map, points, radius, query.options);
}

// A first pose for each kind of points: the same one, unless they contradict each other.
std::optional<ByMap<Pose>> guess_poses(const Query& query, const Pose& predicted,
                                       const ByMap<std::vector<ExpectedPoint>>& expected, float radius) {
  std::optional<Pose> offline, online;
  if (query.options.offline_policy == OfflinePolicy::first) {
    offline = guess(query, predicted, expected.offline, radius);
    const double depth = median_depth(query, expected.offline, predicted);
    const bool as_predicted =
        offline && apparent_shift(*offline, predicted, depth, query.rig) < query.options.narrow_radius;
    if (as_predicted) return ByMap<Pose>{*offline, *offline};
    if (offline) online = guess(query, predicted, expected.online, radius);
    const bool contradict =
        online && apparent_shift(*offline, *online, depth, query.rig) > 0.5 * query.options.narrow_radius;
    if (offline) return ByMap<Pose>{*offline, contradict ? *online : *offline};
  }
  std::vector<ExpectedPoint> all = expected.offline;
  all.insert(all.end(), expected.online.begin(), expected.online.end());
  const auto both = guess(query, predicted, all, radius);
  if (!both) return std::nullopt;
  return ByMap<Pose>{*both, *both};
}

ByMap<std::vector<ExpectedPoint>> project(const Query& query, const ByMap<std::vector<PointId>>& candidates,
                                          const ByMap<Pose>& camera_from_world) {
  return {project_points(query.map, candidates.offline, camera_from_world.offline, query.rig),
          project_points(query.map, candidates.online, camera_from_world.online, query.rig)};
}

ByMap<std::vector<GuidedMatch>> match(const Query& query, const ByMap<std::vector<ExpectedPoint>>& expected) {
  const SearchOptions search{query.options.narrow_radius, 90, 0.9f};
  return {match_expected(*query.frame.features, query.map, expected.offline, search),
          match_expected(*query.frame.features, query.map, expected.online, search)};
}

// A feature that shows a point of each map is left to the offline one.
MeasuredPoints join(const ByMap<MeasuredPoints>& measured, double offline_weight) {
  MeasuredPoints both = measured.offline;
  for (PoseObservation& observation : both.observations) observation.weight = offline_weight;
  for (std::size_t i = 0; i < measured.online.features.size(); ++i) {
    const int feature = measured.online.features[i].feature;
    if (std::ranges::binary_search(measured.offline.features, feature, {}, &TrackedFeature::feature)) continue;
    both.observations.push_back(measured.online.observations[i]);
    both.features.push_back(measured.online.features[i]);
  }
  return both;
}

// The pose of one kind of points alone; empty when it is not sound.
std::optional<PoseRefinement> refine_alone(const Query& query, const Pose& camera_from_world,
                                           const MeasuredPoints& measured) {
  auto refined = refine_pose(camera_from_world, query.rig, measured.observations, query.options.refinement);
  if (refined && !is_sound(*refined, measured.observations.size(), query.options)) refined.reset();
  return refined;
}

// The pose that is believed, and the points it was refined on.
struct Solution {
  PoseRefinement refined;
  MeasuredPoints measured;
};

std::optional<Solution> solve_together(const Query& query, const Pose& camera_from_world,
                                       const ByMap<MeasuredPoints>& measured) {
  MeasuredPoints both = join(measured, query.options.offline_weight);
  const auto refined = refine_pose(camera_from_world, query.rig, both.observations, query.options.refinement);
  if (!refined || !is_sound(*refined, both.observations.size(), query.options)) return std::nullopt;
  return Solution{*refined, std::move(both)};
}

void sort_by_feature(std::vector<TrackedFeature>& features) {
  std::ranges::sort(features, {}, &TrackedFeature::feature);
}

// What the solution says of each offline match. Elsewhere is a point only when its very patch was found there, not just
// a corner that resembles it.
void tell_offline_points(const Query& query, const ByMap<MeasuredPoints>& measured, HybridTrack& result) {
  std::vector<PointId> inliers;
  for (const TrackedFeature& feature : result.tracked.features) {
    if (feature.point.origin == Origin::offline) inliers.push_back(feature.point);
  }
  std::ranges::sort(inliers);
  result.offline_inliers = static_cast<int>(inliers.size());
  for (const TrackedFeature& feature : measured.offline.features) {
    if (std::ranges::binary_search(inliers, feature.point)) continue;
    if (shows_patch(feature, *query.frame.features)) result.offline_moved.push_back(feature.point);
  }
  result.offline_agreed = std::move(inliers);
}

}  // namespace

Agreement agreement_of(const Pose& one, const Pose& other) {
  return {(inverse(one).translation - inverse(other).translation).norm(), angle_between(one.rotation, other.rotation)};
}

bool is_within(const Agreement& agreement, const DriftBound& drift) {
  return agreement.translation <= drift.translation && agreement.rotation <= drift.rotation;
}

std::optional<HybridTrack> track_hybrid(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                        const MapView& map, const std::vector<PointId>& candidates,
                                        const DriftBound& drift, const TrackOptions& options) {
  const Query query{frame, rig, map, options};
  const ByMap<std::vector<PointId>> points = split(candidates);
  const ByMap<Pose> predicted{predicted_camera_from_world, predicted_camera_from_world};
  const ByMap<std::vector<ExpectedPoint>> roughly_expected = project(query, points, predicted);
  std::optional<ByMap<Pose>> guesses;
  for (const float radius : {options.search_radius, options.wide_radius}) {
    if (!guesses) guesses = guess_poses(query, predicted_camera_from_world, roughly_expected, radius);
  }
  if (!guesses) return std::nullopt;

  const ByMap<std::vector<ExpectedPoint>> expected = project(query, points, *guesses);
  const ByMap<std::vector<GuidedMatch>> matches = match(query, expected);
  const ByMap<MeasuredPoints> measured{measure_matches(frame, guesses->offline, rig, map, matches.offline),
                                       measure_matches(frame, guesses->online, rig, map, matches.online)};
  const auto offline = refine_alone(query, guesses->offline, measured.offline);
  const auto online = refine_alone(query, guesses->online, measured.online);

  HybridTrack result;
  if (offline) result.from_offline = offline->camera_from_world;
  if (online) result.from_online = online->camera_from_world;
  if (offline && online) {
    result.maps_disagree =
        disagree(*offline, *online, median_depth(query, expected.offline, *result.from_offline), rig);
  }
  result.offline_is_right = result.maps_disagree && is_sharper_than(drift, *offline) &&
                            is_within(agreement_of(*result.from_offline, *result.from_online), drift);

  std::optional<Solution> solution;
  if (!result.maps_disagree) solution = solve_together(query, offline ? guesses->offline : guesses->online, measured);
  const bool prefer_offline = offline && (!online || result.offline_is_right);
  if (!solution && prefer_offline) solution = Solution{*offline, measured.offline};
  if (!solution && online) solution = Solution{*online, measured.online};
  if (!solution) return std::nullopt;

  std::vector<TrackedFeature> inliers = inliers_of(solution->refined, solution->measured);
  sort_by_feature(inliers);
  const SharedPoints shared = count_shared_points(map, inliers);
  result.offline_reference = most_shared(shared, Origin::offline);
  result.online_reference = most_shared(shared, Origin::online);
  result.tracked =
      tracked_frame(solution->refined, std::move(inliers), most_shared(shared).value_or(KeyframeId{}), map);
  result.offline_expected = static_cast<int>(expected.offline.size());
  result.offline_matches = static_cast<int>(matches.offline.size());
  result.tracked.expected = result.offline_expected + static_cast<int>(expected.online.size());
  result.tracked.outliers = outliers_of(solution->refined, solution->measured);
  result.tracked.matches = result.offline_matches + static_cast<int>(matches.online.size());
  tell_offline_points(query, measured, result);
  return result;
}

}  // namespace byre
