#include "byre/slam/frame/hybrid_tracking.h"

#include "byre/geometry/image_regions.h"
#include "byre/geometry/median.h"
#include "byre/slam/tracking/tracking_steps.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace byre {
namespace {

// Two poses disagree if their difference exceeds both bounds.
constexpr double kMaxApparentShift = 2.0;      // pixels, between the images of the same points
constexpr double kMaxSquaredDeviation = 30.0;  // squared sigmas, six degrees of freedom

// One value for the points of each map.
template <typename Value>
struct ByMap {
  Value offline;
  Value online;
};

// Points expected and matched around the first poses.
struct Found {
  ByMap<ScratchVector<ExpectedPoint>> expected;
  ByMap<MeasuredPoints> measured;
};

struct Query {
  const Frame& frame;
  const Rig& rig;
  const MapView& map;
  const TrackOptions& options;
  HybridLimits limits{};
  ByMap<ScratchVector<PointId>> points{};  // candidates
};

ByMap<ScratchVector<PointId>> split(std::span<const PointId> candidates) {
  ByMap<ScratchVector<PointId>> points;
  points.offline.reserve(candidates.size());
  points.online.reserve(candidates.size());
  for (const PointId id : candidates) (id.origin == Origin::offline ? points.offline : points.online).push_back(id);
  return points;
}

double median_depth(const Query& query, std::span<const ExpectedPoint> points, const Pose& camera_from_world) {
  ScratchVector<double> depths;
  depths.reserve(points.size());
  for (const ExpectedPoint& point : points) {
    depths.push_back((camera_from_world * query.map.find_point(point.id)->position_in_world).z());
  }
  return depths.empty() ? 1.0 : std::max(1e-3, median_of(std::span(depths)));
}

// Distance in pixels between two images of a point at this depth, seen from both poses.
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

std::optional<Pose> guess(const Query& query, const Pose& predicted, std::span<const ExpectedPoint> points) {
  if (points.empty()) return std::nullopt;
  return first_pose(query.frame, predicted, query.rig, query.map, points, query.options);
}

ByMap<ScratchVector<ExpectedPoint>> project(const Query& query, const ByMap<Pose>& camera_from_world) {
  const ImageMask& hidden = query.options.hidden;
  return {project_visible(query.map, query.points.offline, camera_from_world.offline, query.rig, hidden),
          project_visible(query.map, query.points.online, camera_from_world.online, query.rig, hidden)};
}

// Rows of columns and fences repeat, so offline points also fit a pose one bay off.
bool is_another_place(const Pose& offline, const std::optional<Pose>& online, const Pose& predicted,
                      const HybridLimits& limits) {
  if (online) return !is_within(agreement_of(offline, *online), limits.drift);
  return agreement_of(offline, predicted).translation > limits.stray;
}

// First poses by the points of each map: equal, unless they contradict each other within the limits.
std::optional<ByMap<Pose>> guess_poses(const Query& query, const Pose& predicted) {
  const ByMap<ScratchVector<ExpectedPoint>> expected = project(query, {predicted, predicted});
  if (const auto offline = guess(query, predicted, expected.offline)) {
    const double depth = median_depth(query, expected.offline, predicted);
    const auto differ_by = [&](const Pose& other) { return apparent_shift(*offline, other, depth, query.rig); };
    if (differ_by(predicted) < kNarrowRadius) return ByMap<Pose>{*offline, *offline};
    const auto online = guess(query, predicted, expected.online);
    if (is_another_place(*offline, online, predicted, query.limits)) {
      return online ? std::optional(ByMap<Pose>{*online, *online}) : std::nullopt;
    }
    const bool contradict = online && differ_by(*online) > 0.5 * kNarrowRadius;
    return ByMap<Pose>{*offline, contradict ? *online : *offline};
  }
  ScratchVector<ExpectedPoint> all = expected.offline;
  all.insert(all.end(), expected.online.begin(), expected.online.end());
  const auto both = guess(query, predicted, all);
  if (!both) return std::nullopt;
  return ByMap<Pose>{*both, *both};
}

MeasuredPoints match_and_measure(const Query& query, std::span<const ExpectedPoint> expected,
                                 const Pose& camera_from_world) {
  const auto matches = match_expected(*query.frame.features, query.map, expected, {kNarrowRadius, 90, 0.9f});
  return measure_matches(query.frame, camera_from_world, query.rig, query.map, matches);
}

Found look_for(const Query& query, const ByMap<Pose>& guesses) {
  Found found{project(query, guesses), {}};
  found.measured.offline = match_and_measure(query, found.expected.offline, guesses.offline);
  found.measured.online = match_and_measure(query, found.expected.online, guesses.online);
  return found;
}

// A feature that matches points of both maps is left to the offline one.
MeasuredPoints joined(const MeasuredPoints& offline, const MeasuredPoints& online, double offline_weight) {
  MeasuredPoints both;
  both.observations.reserve(offline.observations.size() + online.observations.size());
  both.features.reserve(offline.features.size() + online.features.size());
  both = offline;
  for (PoseObservation& observation : both.observations) observation.weight = offline_weight;
  for (std::size_t i = 0; i < online.features.size(); ++i) {
    const int feature = online.features[i].feature;
    if (std::ranges::binary_search(offline.features, feature, {}, &TrackedFeature::feature)) continue;
    both.observations.push_back(online.observations[i]);
    both.features.push_back(online.features[i]);
  }
  return both;
}

// Pose by the points of one map alone; empty if it is not sound.
std::optional<PoseRefinement> refine_alone(const Query& query, const Pose& camera_from_world,
                                           const MeasuredPoints& measured, int min_inliers) {
  auto refined = refine_pose(camera_from_world, query.rig, measured.observations, {}, query.limits.prior);
  if (refined && !is_sound(*refined, measured.observations.size(), min_inliers)) refined.reset();
  return refined;
}

// A moved object fits a pose of its own as well, but does not fill the image. Precondition: the pose is sound.
bool prevails(const Query& query, const PoseRefinement& offline, const MeasuredPoints& measured) {
  constexpr int kMinMatches = 3;     // matches in a region with evidence
  constexpr int kMinParts = 4;       // image regions with fitting points, a third of all
  constexpr double kMinShare = 0.6;  // share of the regions with evidence that must fit
  struct Part {
    int fit = 0;
    int elsewhere = 0;
  };
  ByImageRegion<Part> parts;
  for (std::size_t i = 0; i < measured.features.size(); ++i) {
    const TrackedFeature& feature = measured.features[i];
    if (!offline.inliers[i] && !shows_patch(feature, *query.frame.features)) continue;
    Part& part = parts[image_region_of(feature.pixel.x(), feature.pixel.y(), query.rig)];
    ++(offline.inliers[i] ? part.fit : part.elsewhere);
  }
  int telling = 0, fitting = 0;  // regions
  for (const Part& part : parts) {
    if (part.fit + part.elsewhere < kMinMatches) continue;
    ++telling;
    fitting += part.fit > part.elsewhere ? 1 : 0;
  }
  return fitting >= kMinParts && fitting >= kMinShare * telling;
}

// Number of matches that fit a pose within noise and systematic errors.
std::size_t count_fitting(const Query& query, const Pose& camera_from_world, const MeasuredPoints& measured) {
  return part_by_agreement(camera_from_world, Matrix6::Zero(), query.rig, measured, 1.0).agreeing.features.size();
}

// The final pose, the points that it was refined on, and the matches left out.
struct Solution {
  PoseRefinement refined;
  MeasuredPoints measured;
  ScratchVector<TrackedFeature> left_out{};
};

std::optional<Solution> solve_together(const Query& query, const Pose& camera_from_world, const MeasuredPoints& offline,
                                       const MeasuredPoints& online) {
  MeasuredPoints both = joined(offline, online, query.options.offline_weight);
  auto refined = refine_pose(camera_from_world, query.rig, both.observations, {}, query.limits.prior);
  if (!refined || !is_sound(*refined, both.observations.size(), query.options.min_inliers)) return std::nullopt;
  return Solution{*std::move(refined), std::move(both)};
}

// Pose by the points of one map, refined on those and on the points of the other map that agree with it, within this
// covariance of its pose.
Solution solve_guided(const Query& query, const PoseRefinement& leader, const Matrix6& covariance, Origin leading,
                      const ByMap<MeasuredPoints>& measured) {
  const bool offline_guides = leading == Origin::offline;
  const MeasuredPoints& of_leader = offline_guides ? measured.offline : measured.online;
  PartedPoints followers =
      part_by_agreement(leader.camera_from_world, covariance, query.rig,
                        offline_guides ? measured.online : measured.offline, leader.variance_factor);
  auto solution = offline_guides ? solve_together(query, leader.camera_from_world, of_leader, followers.agreeing)
                                 : solve_together(query, leader.camera_from_world, followers.agreeing, of_leader);
  if (!solution) solution = Solution{leader, of_leader};
  solution->left_out = std::move(followers.disagreeing);
  return *std::move(solution);
}

// The pose by offline points alone, with the online points that agree with it.
Solution with_followers(const Query& query, PoseRefinement offline, const ByMap<MeasuredPoints>& measured) {
  PartedPoints followers = part_by_agreement(offline.camera_from_world, Matrix6::Zero(), query.rig, measured.online,
                                             offline.variance_factor);
  MeasuredPoints both = joined(measured.offline, followers.agreeing, query.options.offline_weight);
  offline.inlier_count += static_cast<int>(both.features.size() - measured.offline.features.size());
  offline.inliers.resize(both.features.size(), true);
  return {std::move(offline), std::move(both), std::move(followers.disagreeing)};
}

// Poses by each map alone, and their agreement.
struct Opinions {
  std::optional<PoseRefinement> offline;
  std::optional<PoseRefinement> online;
  bool offline_prevails = false;
  bool maps_disagree = false;
};

Opinions solve_each(const Query& query, const ByMap<Pose>& guesses, const Found& found) {
  Opinions opinions;
  constexpr double kOfflineShare = 0.7;  // fewer points suffice if their patches fit
  const int min_inliers = query.options.min_inliers;
  const auto min_offline = static_cast<int>(kOfflineShare * min_inliers);
  opinions.offline = refine_alone(query, guesses.offline, found.measured.offline, min_offline);
  opinions.online = refine_alone(query, guesses.online, found.measured.online, min_inliers);
  opinions.offline_prevails = opinions.offline && prevails(query, *opinions.offline, found.measured.offline);
  if (!opinions.offline || !opinions.online) return opinions;
  const double depth = median_depth(query, found.expected.offline, opinions.offline->camera_from_world);
  opinions.maps_disagree = disagree(*opinions.offline, *opinions.online, depth, query.rig);
  // A compromise between static and moved points fits fewer offline points than the online pose does. Against an online
  // map the inliers must also exceed chance agreement, which is frequent if walls hide expected points.
  if (opinions.maps_disagree && opinions.offline_prevails) {
    constexpr double kMinShare = 0.02;  // share of the offline points in the frustum
    const MeasuredPoints& points = found.measured.offline;
    const auto inliers = static_cast<double>(std::ranges::count(opinions.offline->inliers, true));
    if (inliers < kMinShare * static_cast<double>(found.expected.offline.size())) {
      opinions.offline_prevails = false;
      return opinions;
    }
    opinions.offline_prevails = count_fitting(query, opinions.offline->camera_from_world, points) >=
                                count_fitting(query, opinions.online->camera_from_world, points);
  }
  return opinions;
}

double position_sigma(const PoseRefinement& refined) {
  return std::sqrt(position_variance(refined.covariance));
}

bool is_online_more_precise(const Query& query, const Opinions& opinions) {
  return query.limits.online_sigma < position_sigma(*opinions.offline);
}

// The maps disagree, and the error of the online map's place clearly exceeds that of the offline pose.
bool has_drifted(const Query& query, const Opinions& opinions) {
  constexpr double kClearly = 2.0;
  return opinions.maps_disagree && std::isfinite(query.limits.online_sigma) &&
         query.limits.online_sigma > kClearly * position_sigma(*opinions.offline);
}

std::optional<Solution> solve(const Query& query, const ByMap<Pose>& guesses, const Opinions& opinions,
                              const ByMap<MeasuredPoints>& measured) {
  if (opinions.offline_prevails) {
    if (has_drifted(query, opinions)) return with_followers(query, *opinions.offline, measured);
    const Matrix6 covariance = is_online_more_precise(query, opinions) ? opinions.offline->covariance : Matrix6::Zero();
    return solve_guided(query, *opinions.offline, covariance, Origin::offline, measured);
  }
  if (opinions.maps_disagree) {
    return solve_guided(query, *opinions.online, Matrix6::Zero(), Origin::online, measured);
  }
  auto together =
      solve_together(query, opinions.offline ? guesses.offline : guesses.online, measured.offline, measured.online);
  if (together) return together;
  if (opinions.online) return Solution{*opinions.online, measured.online};
  if (opinions.offline) return Solution{*opinions.offline, measured.offline};
  return std::nullopt;
}

// Splits the offline matches by the solution. A point has moved only if its own patch was found elsewhere, not just a
// similar corner.
void add_offline_points(const Query& query, const ByMap<MeasuredPoints>& measured, HybridTrack& result) {
  ScratchVector<PointId>& inliers = result.offline_agreed;
  inliers.reserve(result.tracked.features.size());
  for (const TrackedFeature& feature : result.tracked.features) {
    if (feature.point.origin == Origin::offline) inliers.push_back(feature.point);
  }
  std::ranges::sort(inliers);
  result.offline_inliers = static_cast<int>(inliers.size());
  result.offline_moved.reserve(measured.offline.features.size());
  for (const TrackedFeature& feature : measured.offline.features) {
    if (std::ranges::binary_search(inliers, feature.point)) continue;
    if (shows_patch(feature, *query.frame.features)) result.offline_moved.push_back(feature.point);
  }
}

HybridTrack to_result(const Query& query, const Found& found, const Opinions& opinions, const Solution& solution) {
  HybridTrack result;
  if (opinions.offline) {
    result.from_offline = opinions.offline->camera_from_world;
    result.offline_sigma = position_sigma(*opinions.offline);
  }
  if (opinions.online) {
    result.from_online = opinions.online->camera_from_world;
    result.from_online_covariance = opinions.online->covariance;
  }
  result.maps_disagree = opinions.maps_disagree;
  result.offline_prevails = opinions.offline_prevails;
  result.online_sigma = query.limits.online_sigma;
  result.depends_on_online = !opinions.offline_prevails || is_online_more_precise(query, opinions);

  ScratchVector<TrackedFeature> inliers = inliers_of(solution.refined, solution.measured);
  std::ranges::sort(inliers, {}, &TrackedFeature::feature);
  const SharedPoints shared = count_shared_points(query.map, inliers);
  result.offline_reference = most_shared(shared, Origin::offline);
  result.online_reference = most_shared(shared, Origin::online);
  result.tracked =
      tracked_frame(solution.refined, std::move(inliers), most_shared(shared).value_or(KeyframeId{}), query.map);
  ScratchVector<TrackedFeature>& outliers = result.tracked.outliers;
  outliers = outliers_of(solution.refined, solution.measured);
  outliers.insert(outliers.end(), solution.left_out.begin(), solution.left_out.end());

  result.offline_expected = static_cast<int>(found.expected.offline.size());
  result.offline_matches = static_cast<int>(found.measured.offline.features.size());
  result.tracked.expected = result.offline_expected + static_cast<int>(found.expected.online.size());
  result.tracked.matches = result.offline_matches + static_cast<int>(found.measured.online.features.size());
  add_offline_points(query, found.measured, result);
  return result;
}

}  // namespace

Agreement agreement_of(const Pose& one, const Pose& other) {
  return {(inverse(one).translation - inverse(other).translation).norm(), angle_between(one.rotation, other.rotation)};
}

bool is_within(const Agreement& agreement, const Agreement& bound) {
  return agreement.translation <= bound.translation && agreement.rotation <= bound.rotation;
}

double sigma_between_maps(const HybridTrack& track) {
  if (!track.from_offline) return std::sqrt(position_variance(track.tracked.match_covariance));
  if (!track.from_online) return track.offline_sigma;
  return std::hypot(track.offline_sigma, agreement_of(*track.from_offline, *track.from_online).translation);
}

std::optional<HybridTrack> track_hybrid(const Frame& frame, const Pose& predicted_camera_from_world, const Rig& rig,
                                        const MapView& map, std::span<const PointId> candidates,
                                        const TrackOptions& options, const HybridLimits& limits,
                                        bool compares_focal_lengths) {
  const Query query{frame, rig, map, options, limits, split(candidates)};
  const auto guesses = guess_poses(query, predicted_camera_from_world);
  if (!guesses) return std::nullopt;
  const Found found = look_for(query, *guesses);
  const Opinions opinions = solve_each(query, *guesses, found);
  const auto solution = solve(query, *guesses, opinions, found.measured);
  if (!solution) return std::nullopt;
  HybridTrack result = to_result(query, found, opinions, *solution);
  if (compares_focal_lengths) {
    const ScratchVector<PoseObservation>& seen = found.measured.offline.observations;
    const auto refined = opinions.offline ? opinions.offline : refine_pose(guesses->offline, rig, seen, {});
    if (refined) result.focal = compare_focal_lengths(refined->camera_from_world, rig, seen);
  }
  return result;
}

SearchedPoints search_points(const Frame& frame, const Pose& camera_from_world, const Rig& rig, const MapView& map,
                             std::span<const PointId> points, const TrackOptions& options) {
  const Query query{frame, rig, map, options};
  const auto expected = project_visible(map, points, camera_from_world, rig, options.hidden);
  const PartedPoints parted = part_by_agreement(camera_from_world, Matrix6::Zero(), rig,
                                                match_and_measure(query, expected, camera_from_world), 1.0);
  SearchedPoints searched;
  for (const TrackedFeature& feature : parted.agreeing.features) searched.agreed.push_back(feature.point);
  for (const TrackedFeature& feature : parted.disagreeing) {
    if (shows_patch(feature, *frame.features)) searched.moved.push_back(feature.point);
  }
  return searched;
}

}  // namespace byre
