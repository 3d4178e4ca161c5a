#include "byre/slam/window/initialisation.h"

#include "byre/alignment.h"
#include "byre/geometry/median.h"
#include "byre/slam/tracking/guided_matching.h"
#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/tracking/measurement.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

namespace byre {
namespace {

// The motion between the two cameras of a start, from images and as measured.
struct StartMotion {
  Pose seen;
  Pose measured;

  StartMotion(const MonocularStart& start, const StartPoses& odometry)
      : seen(start.map.camera_from_world(start.first) * inverse(start.map.camera_from_world(start.second))),
        measured(odometry.first_camera_from_world * inverse(odometry.second_camera_from_world)) {}

  // Measured length over that in images.
  double scale() const { return measured.translation.norm() / seen.translation.norm(); }
};

// Empty if the cameras moved differently than measured.
std::optional<Similarity> placement_of(const MonocularStart& start, const StartPoses& odometry) {
  const StartMotion motion(start, odometry);
  if (!agrees(motion.seen, motion.measured)) return {};
  const double scale = motion.scale();
  const Pose first_from_start = start.map.camera_from_world(start.first);
  return Similarity{scale, inverse(odometry.first_camera_from_world) * scale_lengths(first_from_start, scale)};
}

KeyframeId add_keyframe(const MonocularStart& start, KeyframeId id, const Similarity& world_from_start,
                        const std::optional<KeyframeId>& parent, int recording, MapGraph& map) {
  Keyframe keyframe = *start.map.find_keyframe(id);
  keyframe.rig = map.add_rig(start.map.rigs()[static_cast<std::size_t>(keyframe.rig)]);
  keyframe.recording = recording;
  keyframe.camera_from_world = move_camera(world_from_start, keyframe.camera_from_world);
  keyframe.covariance = scale_lengths(keyframe.covariance, world_from_start.scale);
  keyframe.sightings.clear();
  keyframe.words.clear();
  keyframe.parent = parent;
  return map.add_keyframe(std::move(keyframe));
}

MapPoint moved(const MapPoint& point, const Similarity& world_from_start) {
  const Eigen::Matrix3d rotation = world_from_start.target_from_source.rotation.toRotationMatrix();
  const auto scale = static_cast<float>(world_from_start.scale);
  MapPoint result = point;
  result.position_in_world = world_from_start * point.position_in_world;
  result.covariance =
      world_from_start.scale * world_from_start.scale * rotation * point.covariance * rotation.transpose();
  result.mean_viewing_direction = rotation.cast<float>() * point.mean_viewing_direction;
  result.min_distance *= scale;
  result.max_distance *= scale;
  return result;
}

// Returns the two keyframes.
std::vector<KeyframeId> add_start(const MonocularStart& start, const Similarity& world_from_start,
                                  const std::optional<KeyframeId>& parent, int recording, MapGraph& map) {
  const KeyframeId first = add_keyframe(start, start.first, world_from_start, parent, recording, map);
  const KeyframeId second = add_keyframe(start, start.second, world_from_start, first, recording, map);
  const auto renamed = [&](KeyframeId id) { return id == start.first ? first : second; };
  for (const PointId id : start.map.point_ids()) {
    MapPoint point = moved(*start.map.find_point(id), world_from_start);
    point.reference.keyframe = renamed(point.reference.keyframe);
    const PointId added = map.add_point(point);
    for (const Observation& seen : start.map.observations(id)) {
      Sighting sighting = start.map.find_keyframe(seen.keyframe)->sightings[static_cast<std::size_t>(seen.feature)];
      sighting.point = added;
      map.add_observation({renamed(seen.keyframe), seen.feature}, sighting);
    }
  }
  return {first, second};
}

constexpr SearchOptions kSearch{.radius = 50.0f, .max_distance = 50, .max_ratio = 0.85f};
constexpr int kMinPoints = 80;                // points of the first map with a known depth
constexpr int kMaxPointsPerCell = 16;         // most points that count in one of 4x4 image cells
constexpr double kMaxDirectionSigma = 0.015;  // radians, of the translation between the two keyframes

std::vector<TwoViewMatch> rays_of(const std::vector<Match>& matches, const Features& first, const Features& second,
                                  const Rig& rig) {
  std::vector<TwoViewMatch> rays;
  rays.reserve(matches.size());
  for (const Match& match : matches) {
    const PixelMeasurement in_first = corner_measurement(first.keypoint(match.first));
    const PixelMeasurement in_second = corner_measurement(second.keypoint(match.second));
    const double sigma = std::max(in_first.sigma, in_second.sigma) / rig.focal;
    rays.push_back({rig.ray(in_first.pixel.cast<double>()), rig.ray(in_second.pixel.cast<double>()), sigma});
  }
  return rays;
}

// Scale factor that gives the motion this median depth.
double scale_for(const TwoViewMotion& motion, double median_depth) {
  std::vector<double> depths;
  for (const auto& point : motion.points_in_first) {
    if (point) depths.push_back(point->z());
  }
  return median_depth / median_or(std::move(depths), 0.0);
}

// Adds a point defined by a feature of the first keyframe and measured in the second.
void add_seen_point(MapGraph& map, const Eigen::Vector3d& point_in_world, const Observation& in_first,
                    const Observation& in_second) {
  const Keyframe& first = *map.find_keyframe(in_first.keyframe);
  const Keyframe& second = *map.find_keyframe(in_second.keyframe);
  const Rig& rig = map.rigs()[static_cast<std::size_t>(first.rig)];
  const CameraView first_view{*first.frame.features, rig, first.camera_from_world};
  const CameraView second_view{*second.frame.features, rig, second.camera_from_world};
  const Eigen::Vector2f pixel = first_view.features.keypoint(in_first.feature).pixel;
  const PixelMeasurement measured =
      measure_pixel({first_view, in_first.feature, pixel}, point_in_world, second_view, in_second.feature);
  const float sigma = reference_sigma(first_view.features, in_first.feature);
  const PointId point = map.add_point(
      make_point(point_in_world, Eigen::Matrix3d::Zero(), in_first, first_view.features, first_view.camera_from_world));
  map.add_observation(in_first, {point, pixel, sigma});
  map.add_observation(in_second, {point, measured.pixel, measured.sigma});
}

// Adjusts the second keyframe and the points, and removes outliers. The scale, which is free, hardly changes.
void adjust(MonocularStart& start, const MappingOptions& options) {
  const MapWindow window = window_of(start.map, {start.first, start.second});
  MapWindow adjusted = window;
  adjusted.keyframes.back().movable = true;
  adjust_bundle(adjusted, options);
  remove_weak_points(adjusted, start.second);
  refresh_points(adjusted);
  apply(difference(window, adjusted), start.map);
}

void remove_points_of_unknown_depth(MapGraph& map, const Pose& camera_from_world, double max_relative_sigma) {
  for (const PointId id : map.point_ids()) {
    const MapPoint& point = *map.find_point(id);
    const double max_sigma = max_relative_sigma * (camera_from_world * point.position_in_world).z();
    if (!(point.covariance.trace() < max_sigma * max_sigma)) map.remove_point(id);
  }
}

// Measured rays of the points in both keyframes.
std::vector<TwoViewMatch> measured_rays(const MonocularStart& start, const Rig& rig) {
  const Keyframe& first = *start.map.find_keyframe(start.first);
  const Keyframe& second = *start.map.find_keyframe(start.second);
  std::vector<TwoViewMatch> rays;
  for (const PointId id : start.map.point_ids()) {
    const std::vector<Observation>& seen = start.map.observations(id);
    if (seen.size() != 2) continue;
    const Sighting& in_first = first.sightings[static_cast<std::size_t>(seen.front().feature)];
    const Sighting& in_second = second.sightings[static_cast<std::size_t>(seen.back().feature)];
    const double sigma = std::hypot(in_first.pixel_sigma, in_second.pixel_sigma) / (std::numbers::sqrt2 * rig.focal);
    rays.push_back({rig.ray(in_first.pixel.cast<double>()), rig.ray(in_second.pixel.cast<double>()), sigma});
  }
  return rays;
}

double direction_sigma(const MonocularStart& start, const Rig& rig) {
  const Pose second_from_first =
      start.map.camera_from_world(start.second) * inverse(start.map.camera_from_world(start.first));
  return byre::direction_sigma(second_from_first, measured_rays(start, rig));
}

// Number of points; each image cell counts at most max_per_cell.
int count_spread_points(const Keyframe& keyframe, const Rig& rig, int max_per_cell) {
  constexpr int kCells = 4;  // cells in each direction
  std::array<int, kCells * kCells> counts{};
  const auto cell = [](float pixel, int size) {
    return std::clamp(static_cast<int>(pixel * kCells / static_cast<float>(size)), 0, kCells - 1);
  };
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    const int index = cell(sighting.pixel.y(), rig.height) * kCells + cell(sighting.pixel.x(), rig.width);
    ++counts[static_cast<std::size_t>(index)];
  }
  int spread = 0;
  for (const int count : counts) spread += std::min(count, max_per_cell);
  return spread;
}

TwoViewFailure rejection_reason(const MonocularStart& start, const Rig& rig) {
  const int points = count_spread_points(*start.map.find_keyframe(start.second), rig, kMaxPointsPerCell);
  if (points < kMinPoints) return TwoViewFailure::too_few_points;
  const bool is_open = start.direction_sigma > kMaxDirectionSigma;
  return is_open ? TwoViewFailure::uncertain : TwoViewFailure::none;
}

// First map by the motion between two frames, with a bundle adjustment.
MonocularStart start_from(const TwoViewMotion& motion, const std::vector<Match>& matches, const Frame& first,
                          const Frame& second, const Rig& rig, double median_depth, const MappingOptions& mapping) {
  const double scale = scale_for(motion, median_depth);
  const Pose world_from_first = rig.body_from_camera;
  const Pose first_from_world = inverse(world_from_first);
  Pose second_from_first = motion.second_from_first;
  second_from_first.translation *= scale;
  MonocularStart start{.map = MapGraph(Origin::online), .first = {}, .second = {}};
  start.first = add_keyframe_at(first_from_world, first, rig, std::nullopt, start.map);
  start.second = add_keyframe_at(second_from_first * first_from_world, second, rig, start.first, start.map);
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const auto& point_in_first = motion.points_in_first[i];
    if (!point_in_first) continue;
    add_seen_point(start.map, world_from_first * (scale * *point_in_first), {start.first, matches[i].first},
                   {start.second, matches[i].second});
  }
  adjust(start, mapping);
  remove_points_of_unknown_depth(start.map, first_from_world, mapping.max_relative_depth_sigma);
  start.direction_sigma = direction_sigma(start, rig);
  return start;
}

// Whether a camera stands, by its poses in two frames.
bool is_same_place(const Pose& one, const Pose& other) {
  constexpr double kShift = 0.001;  // metres
  constexpr double kTurn = 0.002;   // radians
  return (one.translation - other.translation).norm() < kShift && angle_between(one.rotation, other.rotation) < kTurn;
}

}  // namespace

MonocularInitialiser::MonocularInitialiser(const Rig& rig, const MonocularStartOptions& options,
                                           const MappingOptions& mapping)
    : rig_(rig), options_(options), mapping_(mapping) {
  assert(!rig.is_stereo());
}

void MonocularInitialiser::begin_with(const Frame& frame) {
  reference_ = frame;
  measured_.reset();
  expected_.clear();
  for (const Keypoint& keypoint : frame.features->keypoints()) expected_.push_back(keypoint.pixel);
}

// At most one match for each feature of either frame; the more similar one wins.
std::vector<Match> MonocularInitialiser::match_with_reference(const Features& features) const {
  const Features& reference = *reference_->features;
  std::vector<Match> claims(static_cast<std::size_t>(features.size()), {-1, -1, std::numeric_limits<int>::max()});
  for (int i = 0; i < reference.size(); ++i) {
    const Eigen::Vector2d expected = expected_[static_cast<std::size_t>(i)].cast<double>();
    const Projection projection{{expected.x(), expected.y(), 0.0}, reference.keypoint(i).octave};
    const auto found = find_feature(features, reference.descriptor(i), projection, kSearch);
    if (!found) continue;
    Match& claim = claims[static_cast<std::size_t>(found->feature)];
    if (found->distance < claim.distance) claim = {i, found->feature, found->distance};
  }
  std::erase_if(claims, [](const Match& claim) { return claim.first < 0; });
  return claims;
}

// Features that were not found are predicted by the median shift of the others.
void MonocularInitialiser::update_expected(const std::vector<Match>& matches, const Features& features) {
  std::vector<float> right, down;
  for (const Match& match : matches) {
    const Eigen::Vector2f shift =
        features.keypoint(match.second).pixel - expected_[static_cast<std::size_t>(match.first)];
    right.push_back(shift.x());
    down.push_back(shift.y());
  }
  const Eigen::Vector2f shift(median_or(std::move(right), 0.0f), median_or(std::move(down), 0.0f));
  for (Eigen::Vector2f& pixel : expected_) pixel += shift;
  for (const Match& match : matches) {
    expected_[static_cast<std::size_t>(match.first)] = features.keypoint(match.second).pixel;
  }
}

MonocularAttempt MonocularInitialiser::try_start(const Frame& frame, bool has_odometry,
                                                 const std::optional<Pose>& measured) {
  MonocularAttempt attempt{std::nullopt, TwoViewFailure::too_few_matches, 0};
  const std::vector<Match> matches = reference_ ? match_with_reference(*frame.features) : std::vector<Match>{};
  attempt.matches = static_cast<int>(matches.size());
  if (attempt.matches < kMinTwoViewMatches) {
    begin_with(frame);
    return attempt;
  }
  update_expected(matches, *frame.features);
  const Features& first = *reference_->features;
  const bool is_standing = measured && measured_ && is_same_place(*measured, *measured_);
  measured_ = measured;
  const StartParallax required = is_standing                 ? StartParallax::least
                                 : has_odometry && !measured ? StartParallax::of_median
                                                             : StartParallax::of_nearest_points;
  const auto estimate = estimate_two_view_motion(rays_of(matches, first, *frame.features, rig_), required, measured);
  attempt.failure = estimate.failure;
  if (!estimate.motion) return attempt;
  MonocularStart start =
      start_from(*estimate.motion, matches, *reference_, frame, rig_, options_.median_depth, mapping_);
  attempt.failure = rejection_reason(start, rig_);
  if (attempt.failure != TwoViewFailure::none) return attempt;
  attempt.start = std::move(start);
  reference_.reset();
  return attempt;
}

std::vector<KeyframeId> add_monocular_submap(const MonocularStart& start, const StartPoses& odometry,
                                             const std::optional<KeyframeId>& parent, int recording, MapGraph& map) {
  const auto placement = placement_of(start, odometry);
  return placement ? add_start(start, *placement, parent, recording, map) : std::vector<KeyframeId>{};
}

std::vector<KeyframeId> add_separate_submap(const MonocularStart& start, const std::optional<KeyframeId>& parent,
                                            int recording, MapGraph& map) {
  return add_start(start, {}, parent, recording, map);
}

bool agrees_with_odometry(const MonocularStart& start, const StartPoses& odometry) {
  constexpr double kDirection = 0.15;  // radians, three sigmas of extrinsics measured by hand
  const StartMotion motion(start, odometry);
  return agrees(motion.seen, motion.measured, {.direction = kDirection});
}

bool is_determined(const Pose& measured, double lever_arm_sigma) {
  constexpr double kLeastWay = 0.05;   // metres
  constexpr double kMostByArm = 0.25;  // share of the motion
  const double way = measured.translation.norm(), turn = rotation_log(measured.rotation).norm();
  return way >= kLeastWay && lever_arm_sigma * turn <= kMostByArm * way;
}

std::optional<double> odometry_scale(const MonocularStart& start, const StartPoses& odometry, double lever_arm_sigma) {
  const StartMotion motion(start, odometry);
  if (!is_determined(motion.measured, lever_arm_sigma) || !(motion.seen.translation.norm() > 0.0)) return {};
  return motion.scale();
}

MonocularStart align_to_odometry(const MonocularStart& start, const StartPoses& odometry, double scale) {
  const Pose second_from_start = scale_lengths(start.map.camera_from_world(start.second), scale);
  MonocularStart result = start;
  result.map = MapGraph(Origin::online);
  const auto keyframes = add_start(start, {scale, inverse(odometry.second_camera_from_world) * second_from_start}, {},
                                   start.map.find_keyframe(start.first)->recording, result.map);
  result.first = keyframes.front();
  result.second = keyframes.back();
  return result;
}

}  // namespace byre
