#include "byre/slam/system/merge_maps.h"

#include "byre/map/scaled_copy.h"
#include "byre/slam/upkeep/replay.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace byre {
namespace {

// Camera of one keyframe in both maps.
struct PlacedKeyframe {
  Pose target_from_camera;
  Pose source_from_camera;
};

// Transform by one keyframe.
Similarity transform_by(const PlacedKeyframe& keyframe, double scale) {
  return {scale, keyframe.target_from_camera * inverse(scale_lengths(keyframe.source_from_camera, scale))};
}

// Keyframes placed by a transform as they were found. Errors grow with the distance from the keyframe of the transform.
std::vector<PlacedKeyframe> agreeing_with(const Similarity& target_from_source, const PlacedKeyframe& by,
                                          const std::vector<PlacedKeyframe>& placed) {
  constexpr double kMetres = 0.3;
  constexpr double kShare = 0.03;   // share of the distance
  constexpr double kRadians = 0.1;  // radians between viewing directions
  std::vector<PlacedKeyframe> agreeing;
  for (const PlacedKeyframe& keyframe : placed) {
    const Pose& found = keyframe.target_from_camera;
    const Pose expected = inverse(move_camera(target_from_source, inverse(keyframe.source_from_camera)));
    const double distance = (found.translation - by.target_from_camera.translation).norm();
    if ((expected.translation - found.translation).norm() > kMetres + kShare * distance) continue;
    if (angle_between(expected.rotation, found.rotation) <= kRadians) agreeing.push_back(keyframe);
  }
  return agreeing;
}

// Scale by the keyframe farthest from this one; empty if all are at one place.
std::optional<double> scale_by_farthest(const PlacedKeyframe& keyframe, const std::vector<PlacedKeyframe>& placed) {
  constexpr double kLeast = 0.5;  // metres
  const auto distance = [&](const PlacedKeyframe& other) {
    return (other.target_from_camera.translation - keyframe.target_from_camera.translation).norm();
  };
  const PlacedKeyframe& farthest = *std::ranges::max_element(placed, {}, distance);
  const double in_source = (farthest.source_from_camera.translation - keyframe.source_from_camera.translation).norm();
  if (distance(farthest) < kLeast || !(in_source > 0.0)) return {};
  return distance(farthest) / in_source;
}

bool has_keyframe_near(const MapGraph& map, const std::vector<KeyframeId>& keyframes, const Pose& map_from_camera) {
  constexpr double kNear = 1.0;     // metres
  constexpr double kMaxTurn = 0.5;  // radians
  return std::ranges::any_of(keyframes, [&](KeyframeId id) {
    const Pose apart = map.camera_from_world(id) * map_from_camera;
    return apart.translation.norm() <= kNear && rotation_log(apart.rotation).norm() <= kMaxTurn;
  });
}

// A similar building has some structure in the same place, but most of its keyframes are not found.
std::string fault_of(const MapPlace& place) {
  constexpr int kLeast = 5;
  constexpr double kLeastShare = 0.6;  // share of the expected keyframes
  if (place.agreeing < kLeast || 2 * place.agreeing <= place.found) {
    return fmt::format("{} of {} keyframes found, {} of these agree on a placement", place.found, place.keyframes,
                       place.agreeing);
  }
  if (place.agreeing >= kLeastShare * place.expected) return {};
  return fmt::format("{} keyframes found where {} should be: a similar building, or one that has changed",
                     place.agreeing, place.expected);
}

// Least squares by all agreeing keyframes, or the transform by one if these do not determine it.
Similarity refined(const Similarity& by_one, const std::vector<PlacedKeyframe>& agreeing, Scale scale) {
  std::vector<Eigen::Vector3d> source, target;
  for (const PlacedKeyframe& keyframe : agreeing) {
    source.push_back(keyframe.source_from_camera.translation);
    target.push_back(keyframe.target_from_camera.translation);
  }
  const auto fitted = align(source, target, scale);
  constexpr double kMostTurn = 0.05;  // radians; positions nearly on a line leave a rotation about it open
  const bool agrees =
      fitted && angle_between(fitted->target_from_source.rotation, by_one.target_from_source.rotation) <= kMostTurn;
  return agrees ? *fitted : by_one;
}

// Both maps in one, without common points.
StoredMap united(const StoredMap& first, const StoredMap& second) {
  StoredMap result = first;
  MapParts parts{first.map.rigs(), {}, {}};
  const auto keyframes = static_cast<std::uint32_t>(first.map.keyframe_count());
  const auto points = static_cast<std::uint32_t>(first.map.point_count());
  for (const KeyframeId id : first.map.keyframe_ids()) parts.keyframes.push_back(*first.map.find_keyframe(id));
  for (const PointId id : first.map.point_ids()) parts.points.push_back(*first.map.find_point(id));
  for (const KeyframeId id : second.map.keyframe_ids()) {
    Keyframe keyframe = *second.map.find_keyframe(id);
    keyframe.rig += static_cast<int>(first.map.rigs().size());
    keyframe.recording += static_cast<int>(first.recordings.size());
    if (keyframe.parent) keyframe.parent = KeyframeId{Origin::offline, keyframe.parent->number + keyframes};
    for (Sighting& sighting : keyframe.sightings) {
      if (sighting.point) sighting.point = PointId{Origin::offline, sighting.point->number + points};
    }
    parts.keyframes.push_back(std::move(keyframe));
  }
  for (const PointId id : second.map.point_ids()) {
    MapPoint point = *second.map.find_point(id);
    point.reference.keyframe = {Origin::offline, point.reference.keyframe.number + keyframes};
    parts.points.push_back(point);
  }
  const std::vector<Rig>& rigs = second.map.rigs();
  parts.rigs.insert(parts.rigs.end(), rigs.begin(), rigs.end());
  result.map = MapGraph(Origin::offline, std::move(parts));
  result.recordings.insert(result.recordings.end(), second.recordings.begin(), second.recordings.end());
  return result;
}

// Evenly distributed keyframes.
std::vector<ReplayFrame> frames_to_search(const StoredMap& source) {
  constexpr std::size_t kMost = 200;
  std::vector<ReplayFrame> frames = frames_to_replay(source.map);
  const std::size_t step = frames.size() / kMost + 1;
  std::vector<ReplayFrame> some;
  for (std::size_t i = 0; i < frames.size(); i += step) some.push_back(std::move(frames[i]));
  return some;
}

}  // namespace

MapPlace place_in(const StoredMap& target, const StoredMap& source, const Vocabulary& vocabulary) {
  const std::vector<ReplayFrame> frames = frames_to_search(source);
  const std::vector<Replayed> found = replay(frames, target.map, index_of(target.map, vocabulary));
  std::vector<PlacedKeyframe> placed;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (!found[i].camera_from_world) continue;
    placed.push_back({inverse(*found[i].camera_from_world), inverse(frames[i].camera_from_world)});
  }
  const bool is_metric = source.scale == MapScale::metric && target.scale == MapScale::metric;
  std::vector<PlacedKeyframe> most;
  MapPlace place{static_cast<int>(frames.size()), static_cast<int>(placed.size())};
  for (const PlacedKeyframe& keyframe : placed) {
    const std::optional<double> scale = is_metric ? 1.0 : scale_by_farthest(keyframe, placed);
    if (!scale) continue;
    const Similarity by_one = transform_by(keyframe, *scale);
    std::vector<PlacedKeyframe> agreeing = agreeing_with(by_one, keyframe, placed);
    if (agreeing.size() <= most.size()) continue;
    most = std::move(agreeing);
    place.target_from_source = refined(by_one, most, is_metric ? Scale::fixed : Scale::free);
  }
  place.agreeing = static_cast<int>(most.size());
  if (place.target_from_source) {
    const std::vector<KeyframeId> keyframes = target.map.keyframe_ids();
    place.expected = static_cast<int>(std::ranges::count_if(frames, [&](const ReplayFrame& frame) {
      return has_keyframe_near(target.map, keyframes,
                               inverse(move_camera(*place.target_from_source, frame.camera_from_world)));
    }));
  }
  place.fault = fault_of(place);
  return place;
}

MergedMaps merge_maps(StoredMap& first, const StoredMap& second, const Vocabulary& vocabulary,
                      const FinishHooks& hooks) {
  if (hooks.before_step) hooks.before_step("placing the second map in the first");
  MergedMaps merged{place_in(first, second, vocabulary)};
  if (!merged.place.fault.empty()) {
    merged.refusal = "the second map was not placed in the first: " + merged.place.fault;
    return merged;
  }
  FinishOptions finish;
  finish.first_new = static_cast<std::uint32_t>(first.map.keyframe_count());
  finish.loops.min_gap = 0;  // tracking did not connect the maps
  first = united(first, transformed_copy(second, *merged.place.target_from_source));
  merged.finishing = refine_map(first, vocabulary, hooks, finish);
  const FinishReport& report = merged.finishing.report;
  if (report.after.parts >= report.before.parts) merged.refusal = "no loop between the maps was confirmed";
  return merged;
}

}  // namespace byre
