#include "byre/slam/window/map_from_poses.h"

#include "byre/slam/tracking/keyframes.h"
#include "byre/slam/window/mapping_steps.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace byre {
namespace {

// Sample of the scene points in view of a keyframe.
struct SeenPart {
  KeyframeId id;
  Pose camera_from_world;
  Eigen::Vector3d camera_in_world;
  std::vector<Eigen::Vector3d> points_in_world;
};

// Samples features at their stereo depths, or at the assumed depth without stereo.
SeenPart seen_part(const MapGraph& map, KeyframeId id, double assumed_depth) {
  constexpr int kSamples = 60;
  const Keyframe& keyframe = *map.find_keyframe(id);
  const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  const Pose world_from_camera = inverse(keyframe.camera_from_world);
  SeenPart part{id, keyframe.camera_from_world, world_from_camera.translation, {}};
  const int step = std::max(1, keyframe.frame.features->size() / kSamples);
  for (int feature = 0; feature < keyframe.frame.features->size(); feature += step) {
    const Keypoint& keypoint = keyframe.frame.features->keypoint(feature);
    const Eigen::Vector2d pixel = keypoint.pixel.cast<double>();
    const bool has_depth = rig.is_stereo() && keypoint.has_disparity();
    if (rig.is_stereo() && !has_depth) continue;
    const double depth = has_depth ? rig.focal * rig.baseline / keypoint.disparity : assumed_depth;
    part.points_in_world.push_back(world_from_camera * (depth * rig.ray(pixel)));
  }
  return part;
}

// Whether another camera has a point in view from a similar side and distance.
bool is_recognisable(const Eigen::Vector3d& point_in_world, const SeenPart& from, const SeenPart& in, const Rig& rig) {
  constexpr double kMinViewingCosine = 0.7;
  constexpr double kMaxDistanceRatio = 2.5;
  const Eigen::Vector3d point_in_camera = in.camera_from_world * point_in_world;
  if (point_in_camera.z() <= 0.0 || !rig.contains(rig.project(point_in_camera).head<2>())) return false;
  const Eigen::Vector3d first_ray = point_in_world - from.camera_in_world;
  const Eigen::Vector3d second_ray = point_in_world - in.camera_in_world;
  const double ratio = first_ray.norm() / second_ray.norm();
  return first_ray.dot(second_ray) > kMinViewingCosine * first_ray.norm() * second_ray.norm() &&
         ratio < kMaxDistanceRatio && ratio > 1.0 / kMaxDistanceRatio;
}

// Share of each part that the other camera sees; the smaller one.
double overlap(const SeenPart& first, const SeenPart& second, const Rig& first_rig, const Rig& second_rig) {
  const auto share = [](const SeenPart& part, const SeenPart& viewer, const Rig& rig) {
    const auto seen = std::ranges::count_if(
        part.points_in_world, [&](const Eigen::Vector3d& point) { return is_recognisable(point, part, viewer, rig); });
    return part.points_in_world.empty() ? 0.0 : static_cast<double>(seen) / part.points_in_world.size();
  };
  const double in_second = share(first, second, second_rig);
  return in_second == 0.0 ? 0.0 : std::min(in_second, share(second, first, first_rig));
}

void add_frames(MapGraph& map, const std::vector<Rig>& rigs, const std::vector<PosedFrame>& frames) {
  std::optional<KeyframeId> previous;
  for (const PosedFrame& posed : frames) {
    const Rig& rig = rigs[static_cast<std::size_t>(posed.rig)];
    previous = add_keyframe_at(posed.camera_from_world, posed.frame, rig, previous, map);
    if (rig.is_stereo()) add_stereo_points(map, *previous);
  }
}

// Adds points that the keyframe shares with its neighbours.
void connect(MapGraph& map, KeyframeId id, const std::vector<KeyframeId>& neighbours, const KnownPoseOptions& options) {
  MappingOptions mapping = options.mapping;
  mapping.triangulation_neighbours = mapping.fusion_neighbours = options.neighbours;
  mapping.search_radius = options.search_radius;
  mapping.pose_sigma = options.pose_sigma;
  std::vector<KeyframeId> keyframes = {id};
  keyframes.insert(keyframes.end(), neighbours.begin(), neighbours.end());
  const MapWindow window = window_of(map, keyframes);
  MapWindow connected = window;
  fuse_duplicates(connected, 0, mapping);
  triangulate_new_points(connected, 0, mapping);
  apply(difference(window, connected), map);
}

// Adds the errors of poses to the sigmas of measurements.
void add_pose_errors(MapWindow& window, double pose_sigma) {
  for (WindowKeyframe& keyframe : window.keyframes) {
    for (Sighting& sighting : keyframe.keyframe.sightings) {
      sighting.pixel_sigma = std::hypot(sighting.pixel_sigma, static_cast<float>(pose_sigma));
    }
  }
}

// Refines all points together: with fixed poses they are independent.
void refine_points(MapGraph& map, const KnownPoseOptions& options) {
  if (map.keyframe_count() == 0) return;
  const MapWindow window = window_of(map, map.keyframe_ids());
  MapWindow settled = window;
  add_pose_errors(settled, options.pose_sigma);
  adjust_points(settled, options.mapping);
  // The oldest keyframe as reference: removes only points of one view without a depth.
  remove_weak_points(settled, settled.keyframes.front().id);
  refresh_points(settled);
  apply(difference(window, settled), map);
}

}  // namespace

std::vector<std::vector<KeyframeId>> overlapping_keyframes(const MapGraph& map, const KnownPoseOptions& options) {
  constexpr double kMinOverlap = 0.1;
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  std::vector<SeenPart> parts;
  for (const KeyframeId id : ids) parts.push_back(seen_part(map, id, options.assumed_depth));
  const auto rig_of = [&map](const SeenPart& part) -> const Rig& {
    return map.rigs()[static_cast<std::size_t>(map.find_keyframe(part.id)->rig)];
  };
  std::vector<std::vector<std::pair<double, KeyframeId>>> ranked(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    for (std::size_t j = i + 1; j < ids.size(); ++j) {
      const double shared = overlap(parts[i], parts[j], rig_of(parts[i]), rig_of(parts[j]));
      if (shared < kMinOverlap) continue;
      ranked[i].emplace_back(-shared, ids[j]);
      ranked[j].emplace_back(-shared, ids[i]);
    }
  }
  std::vector<std::vector<KeyframeId>> neighbours(ids.size());
  for (std::size_t i = 0; i < ids.size(); ++i) {
    std::ranges::sort(ranked[i]);
    const std::size_t count = std::min(ranked[i].size(), static_cast<std::size_t>(options.neighbours));
    for (std::size_t n = 0; n < count; ++n) neighbours[i].push_back(ranked[i][n].second);
  }
  return neighbours;
}

MapGraph map_from_poses(const std::vector<Rig>& rigs, const std::vector<PosedFrame>& frames,
                        const KnownPoseOptions& options) {
  MapGraph map(Origin::online);
  add_frames(map, rigs, frames);
  const std::vector<KeyframeId> ids = map.keyframe_ids();
  const auto neighbours = overlapping_keyframes(map, options);
  for (std::size_t i = 0; i < ids.size(); ++i) connect(map, ids[i], neighbours[i], options);
  refine_points(map, options);
  return map;
}

}  // namespace byre
