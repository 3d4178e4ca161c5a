#include "byre/map.h"

#include "byre/features/jpeg.h"
#include "byre/geometry/polygon.h"
#include "byre/input_error.h"
#include "byre/map/map_file.h"
#include "byre/map/mapped_tag.h"
#include "byre/map/plan/driving_plane.h"
#include "byre/map/plan/floor_plan.h"
#include "byre/map/point_grey.h"
#include "byre/map/scaled_copy.h"
#include "byre/map/stored_calibration.h"
#include "byre/place/map_words.h"
#include "byre/slam/system/merge_maps.h"
#include "byre/slam/system/stored_map.h"
#include "byre/slam/upkeep/update_map.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

KeyframeId keyframe_id(int number) {
  return {Origin::offline, static_cast<std::uint32_t>(number)};
}

PointId point_id(int number) {
  return {Origin::offline, static_cast<std::uint32_t>(number)};
}

int number_of(const OptionalPoint& point) {
  return point ? static_cast<int>(point->number) : -1;
}

// Ids by position, metres.
using Positions = std::multimap<std::array<double, 3>, int>;

void add(const Eigen::Vector3d& position, std::uint32_t number, Positions& positions) {
  positions.insert({{position.x(), position.y(), position.z()}, static_cast<int>(number)});
}

Positions point_positions(const MapGraph& map) {
  Positions positions;
  for (const PointId id : map.point_ids()) add(map.find_point(id)->position_in_world, id.number, positions);
  return positions;
}

Positions camera_positions(const MapGraph& map) {
  Positions positions;
  for (const KeyframeId id : map.keyframe_ids()) {
    add(inverse(map.keyframe_header(id)->camera_from_world).translation, id.number, positions);
  }
  return positions;
}

std::vector<int> missing_in(const Positions& others, const Positions& positions) {
  std::vector<int> missing;
  for (const auto& [position, id] : positions) {
    if (!others.contains(position)) missing.push_back(id);
  }
  std::ranges::sort(missing);
  return missing;
}

const Keyframe& keyframe_at(const StoredMap& stored, int id) {
  const Keyframe* const keyframe = stored.map.find_keyframe(keyframe_id(id));
  assert(keyframe != nullptr);
  return *keyframe;
}

const MapPoint& point_at(const StoredMap& stored, int id) {
  const MapPoint* const point = stored.map.find_point(point_id(id));
  assert(point != nullptr);
  return *point;
}

// Camera of a recording's last keyframe; nullptr without keyframes.
const Rig* rig_of_recording(const StoredMap& stored, int recording) {
  const Rig* rig = nullptr;
  for (int i = 0; i < stored.map.keyframe_count(); ++i) {
    const Keyframe& keyframe = keyframe_at(stored, i);
    if (keyframe.recording == recording) rig = &rig_of(stored.map, keyframe);
  }
  return rig;
}

template <typename Predicate>
std::vector<int> points_where(const StoredMap& stored, Predicate holds) {
  std::vector<int> points;
  for (int i = 0; i < stored.map.point_count(); ++i) {
    if (holds(point_at(stored, i).position_in_world)) points.push_back(i);
  }
  return points;
}

using AtDistance = std::pair<double, int>;  // distance and number: ordered by distance, ties by number

std::vector<int> numbers_of(const std::vector<AtDistance>& items) {
  std::vector<int> numbers;
  for (const auto& [distance, number] : items) numbers.push_back(number);
  return numbers;
}

bool observes_points(const Keyframe& keyframe) {
  return std::ranges::any_of(keyframe.sightings, [](const Sighting& sighting) { return sighting.point.has_value(); });
}

}  // namespace

Map::Map(StoredMap stored) : stored_(std::make_shared<const StoredMap>(std::move(stored))) {}

Map Map::load(const std::filesystem::path& path) {
  return Map(load_map(path));
}

void Map::save(const std::filesystem::path& path) const {
  save_map(*stored_, path);
}

Map Map::from_bytes(std::span<const std::byte> bytes, const std::string& name) {
  return Map(read_map(bytes, name));
}

std::vector<std::byte> Map::to_bytes() const {
  return write_map(*stored_);
}

int Map::keyframes() const {
  return stored_->map.keyframe_count();
}

int Map::points() const {
  return stored_->map.point_count();
}

int Map::observations() const {
  int sum = 0;
  for (const int count : observation_counts()) sum += count;
  return sum;
}

bool Map::is_metric() const {
  return stored_->scale == MapScale::metric;
}

std::string Map::summary() const {
  const std::size_t recordings = stored_->recordings.size();
  return fmt::format("{} keyframes, {} points, {} recording{}, {}{}", keyframes(), points(), recordings,
                     recordings == 1 ? "" : "s", is_metric() ? "metric" : "of unknown scale",
                     stored_->plan ? ", registered on " + stored_->plan->plan : "");
}

std::vector<MapRecording> Map::recordings() const {
  std::vector<MapRecording> recordings;
  for (const SourceRecording& source : stored_->recordings) {
    recordings.push_back({source.name, source.present_calibration(), source.first_time, source.last_time});
  }
  return recordings;
}

const std::map<std::string, std::string>& Map::notes() const {
  return stored_->notes;
}

std::vector<MapHistory> Map::history() const {
  return history_of(*stored_);
}

MapDifference Map::difference(const Map& after) const {
  const Positions points_before = point_positions(stored_->map), points_after = point_positions(after.stored_->map);
  const Positions cameras_before = camera_positions(stored_->map), cameras_after = camera_positions(after.stored_->map);
  return {.removed_keyframes = missing_in(cameras_after, cameras_before),
          .removed_points = missing_in(points_after, points_before),
          .added_keyframes = missing_in(cameras_before, cameras_after),
          .added_points = missing_in(points_before, points_after)};
}

const std::optional<PlanRegistration>& Map::plan() const {
  return stored_->plan;
}

std::vector<MappedTag> Map::tags() const {
  return stored_tags(stored_->notes);
}

MapKeyframe Map::keyframe(int id) const {
  const Keyframe& keyframe = keyframe_at(*stored_, id);
  MapKeyframe result;
  result.id = id;
  result.time = keyframe.frame.time;
  result.recording = keyframe.recording;
  if (keyframe.parent) result.parent = static_cast<int>(keyframe.parent->number);
  result.rig = rig_of(stored_->map, keyframe);
  result.map_from_camera = inverse(keyframe.camera_from_world);
  result.map_from_body = inverse(result.rig.body_from_camera * keyframe.camera_from_world);
  result.covariance = move_covariance(keyframe.covariance, result.rig.body_from_camera);
  result.features = keyframe.frame.features ? keyframe.frame.features : std::make_shared<const Features>();
  for (const Sighting& sighting : keyframe.sightings) {
    result.pixels.push_back(sighting.pixel);
    result.points.push_back(number_of(sighting.point));
  }
  return result;
}

std::optional<Image> Map::picture(int keyframe) const {
  const StoredPicture& stored = keyframe_at(*stored_, keyframe).picture;
  if (!stored) return std::nullopt;
  std::optional<Image> picture = decode_jpeg(stored.jpeg());
  if (!picture) {
    throw InputError("map", fmt::format("has a picture of keyframe {} that is no JPEG file", keyframe),
                     "restore the map from a copy, or make it again");
  }
  return picture;
}

Trajectory Map::trajectory(int recording) const {
  Trajectory poses;
  for (int i = 0; i < keyframes(); ++i) {
    const Keyframe& keyframe = keyframe_at(*stored_, i);
    if (keyframe.recording != recording) continue;
    const Rig& rig = rig_of(stored_->map, keyframe);
    poses.push_back({keyframe.frame.time, inverse(rig.body_from_camera * keyframe.camera_from_world)});
  }
  std::ranges::stable_sort(poses, {}, &StampedPose::time);
  const auto repeated = std::ranges::unique(poses, {}, &StampedPose::time);
  poses.erase(repeated.begin(), repeated.end());
  return poses;
}

const Eigen::Vector3d& Map::position(int point) const {
  return point_at(*stored_, point).position_in_world;
}

const Eigen::Matrix3d& Map::covariance(int point) const {
  return point_at(*stored_, point).covariance;
}

std::optional<std::uint8_t> Map::grey(int point) const {
  return grey_of(stored_->map, point_at(*stored_, point));
}

std::vector<MapObservation> Map::observations(int point) const {
  std::vector<MapObservation> result;
  for (const Observation& seen : stored_->map.observations(point_id(point))) {
    const int number = static_cast<int>(seen.keyframe.number);
    const Sighting& sighting = keyframe_at(*stored_, number).sightings[static_cast<std::size_t>(seen.feature)];
    result.push_back({number, seen.feature, sighting.pixel, sighting.pixel_sigma});
  }
  return result;
}

std::vector<Eigen::Vector3d> Map::positions() const {
  std::vector<Eigen::Vector3d> result;
  for (int i = 0; i < points(); ++i) result.push_back(position(i));
  return result;
}

std::vector<Eigen::Matrix3d> Map::covariances() const {
  std::vector<Eigen::Matrix3d> result;
  for (int i = 0; i < points(); ++i) result.push_back(covariance(i));
  return result;
}

std::vector<int> Map::observation_counts() const {
  std::vector<int> counts;
  for (int i = 0; i < points(); ++i) {
    counts.push_back(static_cast<int>(stored_->map.observations(point_id(i)).size()));
  }
  return counts;
}

std::vector<int> Map::recording_counts() const {
  std::vector<int> recording_of;
  for (int i = 0; i < keyframes(); ++i) recording_of.push_back(keyframe_at(*stored_, i).recording);
  std::vector<int> counts;
  for (int i = 0; i < points(); ++i) {
    std::vector<int> seen_by;
    for (const Observation& seen : stored_->map.observations(point_id(i))) {
      seen_by.push_back(recording_of[seen.keyframe.number]);
    }
    std::ranges::sort(seen_by);
    const auto repeated = std::ranges::unique(seen_by);
    counts.push_back(static_cast<int>(repeated.begin() - seen_by.begin()));
  }
  return counts;
}

std::vector<int> Map::points_in_view(const Pose& map_from_body, double max_distance, int recording) const {
  const Rig* const rig = rig_of_recording(*stored_, recording);
  if (rig == nullptr) return {};
  const Pose camera_from_map = inverse(map_from_body * rig->body_from_camera);
  return points_where(*stored_, [&](const Eigen::Vector3d& position) {
    const Eigen::Vector3d in_camera = camera_from_map * position;
    return in_camera.z() > 0.0 && in_camera.norm() <= max_distance && rig->contains(rig->project(in_camera).head<2>());
  });
}

std::vector<int> Map::nearest_points(const Eigen::Vector3d& place_in_map, int count) const {
  std::vector<AtDistance> nearest;
  if (!place_in_map.allFinite()) return {};
  for (int i = 0; i < points(); ++i) nearest.push_back({(position(i) - place_in_map).norm(), i});
  const auto kept = static_cast<std::size_t>(std::clamp(count, 0, points()));
  std::ranges::partial_sort(nearest, nearest.begin() + static_cast<std::ptrdiff_t>(kept));
  nearest.resize(kept);
  return numbers_of(nearest);
}

std::vector<int> Map::points_in_box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const {
  return points_where(*stored_, [&](const Eigen::Vector3d& position) {
    return (position.array() >= low.array()).all() && (position.array() <= high.array()).all();
  });
}

std::vector<int> Map::points_in_sphere(const Eigen::Vector3d& centre_in_map, double radius) const {
  return points_where(*stored_,
                      [&](const Eigen::Vector3d& position) { return (position - centre_in_map).norm() <= radius; });
}

std::vector<int> Map::points_in_polygon(std::span<const Eigen::Vector2d> corners_in_plan) const {
  if (!stored_->plan) {
    throw InputError("map", "is not registered on a floor plan, so it has no positions on a plan",
                     "register it (register_on_plan), or select points by their positions in the map");
  }
  const Similarity& plan_from_map = stored_->plan->plan_from_map;
  return points_where(*stored_, [&](const Eigen::Vector3d& position) {
    return is_inside(corners_in_plan, (plan_from_map * position).head<2>());
  });
}

std::vector<int> Map::keyframes_near(const Eigen::Vector3d& place_in_map, double radius) const {
  std::vector<AtDistance> near;
  for (int i = 0; i < keyframes(); ++i) {
    const Eigen::Vector3d camera_in_map = inverse(keyframe_at(*stored_, i).camera_from_world).translation;
    const double distance = (camera_in_map - place_in_map).norm();
    if (distance <= radius) near.push_back({distance, i});
  }
  std::ranges::sort(near);
  return numbers_of(near);
}

Map Map::without_points(std::span<const int> points) const {
  StoredMap edited = *stored_;
  for (const int point : points) {
    if (point >= 0) edited.map.remove_point(point_id(point));
  }
  for (const KeyframeId id : edited.map.keyframe_ids()) {
    const bool has_lost_all =
        observes_points(*stored_->map.find_keyframe(id)) && !observes_points(*edited.map.find_keyframe(id));
    if (has_lost_all) edited.map.remove_keyframe(id);
  }
  edited.map = offline_copy(std::move(edited.map));
  return Map(std::move(edited));
}

Map Map::transformed(const Similarity& target_from_map) const {
  const auto& [scale, pose] = target_from_map;
  if (!(scale > 0.0) || !std::isfinite(scale) || !pose.translation.allFinite() || !pose.rotation.coeffs().allFinite()) {
    throw InputError("transform", "is not a similarity", "give a positive scale and finite numbers");
  }
  return Map(transformed_copy(*stored_, target_from_map));
}

Map Map::merged_with(const Map& other, const std::optional<std::filesystem::path>& vocabulary) const {
  const Vocabulary words = open_vocabulary(vocabulary);
  StoredMap merged = *stored_, second = *other.stored_;
  add_words(merged, words);
  add_words(second, words);
  const MergedMaps result = merge_maps(merged, second, words, {[] { return false; }, {}});
  if (!result.refusal.empty()) {
    throw InputError("map", "cannot be merged: " + result.refusal,
                     "record where both maps overlap, and extend one by that recording");
  }
  return Map(std::move(merged));
}

PlanFit Map::register_on_plan(const std::string& plan, std::span<const PlanCorrespondence> picks,
                              const PlanRegistrationOptions& options) const {
  const DrivingPlane plane = require_driving_plane(stored_->map, up_of_base(*stored_), "map");
  std::optional<PlanFit> fit = byre::register_on_plan(picks, plane, is_metric() ? Scale::fixed : Scale::free, options);
  if (!fit) {
    throw InputError("picks", "need two distant points to register the map on the plan",
                     "pick three or more distant points");
  }
  fit->registration.plan = plan;
  return std::move(*fit);
}

Map Map::with_plan(const PlanFit& fit, double accepted_residual) const {
  if (const double residual = residual_of(fit); !(residual <= accepted_residual)) {
    throw InputError(
        "picks",
        fmt::format("have residuals of {:.2f} m on the map: poses on the plan would have the same error", residual),
        "correct wrong picks, the plan's resolution or its origin, or accept this residual");
  }
  StoredMap edited = *stored_;
  edited.plan = fit.registration;
  return Map(std::move(edited));
}

Map Map::with_tags(std::span<const Tag> surveyed) const {
  if (!plan()) {
    throw InputError("map", "is not registered on a floor plan, so surveyed tags have no place in it",
                     "register it on the plan");
  }
  StoredMap edited = *stored_;
  add_surveyed_tags(edited, surveyed);
  return Map(std::move(edited));
}

}  // namespace byre
