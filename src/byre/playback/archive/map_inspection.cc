#include "byre/playback/archive/map_inspection.h"

#include "byre/map/keyframe_path.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace byre {
namespace {

int count_patches(const Keyframe& keyframe) {
  int patches = 0;
  for (int i = 0; i < static_cast<int>(keyframe.sightings.size()); ++i) {
    patches += keyframe.frame.features->find_patch(i) ? 1 : 0;
  }
  return patches;
}

MapCounts count(const MapGraph& map) {
  MapCounts counts;
  counts.keyframes = map.keyframe_count();
  counts.points = map.point_count();
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    counts.keyframes_with_words += keyframe.words.empty() ? 0 : 1;
    counts.keyframes_with_picture += keyframe.picture ? 1 : 0;
    counts.picture_bytes += keyframe.picture.size();
    counts.features += static_cast<int>(keyframe.sightings.size());
    counts.observations += static_cast<int>(
        std::ranges::count_if(keyframe.sightings, [](const Sighting& s) { return s.point.has_value(); }));
    counts.patches += count_patches(keyframe);
  }
  return counts;
}

Distribution observations_per_point(const MapGraph& map) {
  std::vector<double> observations;
  for (const PointId id : map.point_ids()) observations.push_back(static_cast<double>(map.observations(id).size()));
  return distribution_of(std::move(observations));
}

ReprojectionErrors reprojection_errors(const MapGraph& map) {
  std::vector<double> pixel_errors;
  std::vector<double> disparity_errors;
  ReprojectionErrors errors;
  for (const KeyframeId id : map.keyframe_ids()) {
    const Keyframe& keyframe = *map.find_keyframe(id);
    const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
    for (std::size_t i = 0; i < keyframe.sightings.size(); ++i) {
      const Sighting& sighting = keyframe.sightings[i];
      if (!sighting.point) continue;
      const Eigen::Vector3d point_in_camera =
          keyframe.camera_from_world * map.find_point(*sighting.point)->position_in_world;
      if (point_in_camera.z() <= 0.0) {
        ++errors.behind_camera;
        continue;
      }
      const StereoPixel projected = rig.project(point_in_camera);
      pixel_errors.push_back((sighting.pixel.cast<double>() - projected.head<2>()).norm());
      const Keypoint& keypoint = keyframe.frame.features->keypoint(static_cast<int>(i));
      if (keypoint.has_disparity()) disparity_errors.push_back(std::abs(keypoint.disparity - projected.z()));
    }
  }
  errors.pixel = distribution_of(std::move(pixel_errors));
  errors.disparity = distribution_of(std::move(disparity_errors));
  return errors;
}

Eigen::AlignedBox3d bounding_box(const MapGraph& map) {
  Eigen::AlignedBox3d box;
  for (const PointId id : map.point_ids()) box.extend(map.find_point(id)->position_in_world);
  return box;
}

// A stereo calibration has a right camera. Without one, a baseline in the keyframes' rigs indicates a depth camera.
std::vector<std::string> cameras_of_recordings(const StoredMap& stored) {
  std::vector<std::string> cameras;
  for (const SourceRecording& recording : stored.recordings) {
    cameras.emplace_back(recording.calibration.right ? "stereo" : "mono");
  }
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.find_keyframe(id);
    const bool has_baseline = stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)].is_stereo();
    std::string& camera = cameras[static_cast<std::size_t>(keyframe.recording)];
    if (has_baseline && camera == "mono") camera = "rgbd";
  }
  return cameras;
}

// Summed per recording, because the motion between recordings is unknown.
double path_of_keyframes(const StoredMap& stored) {
  std::vector<Trajectory> paths(stored.recordings.size());
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.find_keyframe(id);
    paths[static_cast<std::size_t>(keyframe.recording)].push_back(
        {keyframe.frame.time, world_from_body(stored.map, keyframe)});
  }
  double length = 0.0;
  for (Trajectory& path : paths) {
    std::ranges::stable_sort(path, {}, &StampedPose::time);
    length += path_length(path);
  }
  return length;
}

std::size_t covisible_count(const MapGraph& map) {
  std::size_t covisible = 0;
  for (const KeyframeId id : map.keyframe_ids()) {
    covisible += map.covisible_keyframes(id, std::numeric_limits<int>::max()).size();
  }
  return covisible;
}

// Size of the containers' elements, without spare capacity.
std::vector<SectionSize> memory_of(const MapGraph& map, const MapCounts& counts) {
  const auto size = [](int number, std::size_t bytes) { return static_cast<std::size_t>(number) * bytes; };
  std::size_t words = 0;
  for (const KeyframeId id : map.keyframe_ids()) words += map.find_keyframe(id)->words.size();
  return {{"keyframes", size(counts.keyframes, sizeof(Keyframe) + sizeof(Features))},
          {"features", size(counts.features, sizeof(Keypoint) + sizeof(Descriptor))},
          {"patches", size(counts.patches, sizeof(Patch))},
          {"sightings", size(counts.features, sizeof(Sighting))},
          {"points", size(counts.points, sizeof(MapPoint))},
          {"observations", size(counts.observations, sizeof(Observation))},
          {"covisibility", covisible_count(map) * sizeof(Covisible)},
          {"words", words * sizeof(Word)},
          {"pictures", counts.picture_bytes}};
}

}  // namespace

MapInspection inspect(const StoredMap& stored) {
  MapInspection inspection;
  inspection.counts = count(stored.map);
  inspection.counts.keyframes_of_recordings = keyframes_of_recordings(stored.map, stored.recordings.size());
  inspection.cameras_of_recordings = cameras_of_recordings(stored);
  inspection.observations_per_point = observations_per_point(stored.map);
  inspection.errors = reprojection_errors(stored.map);
  inspection.points_in_world = bounding_box(stored.map);
  inspection.path_length = path_of_keyframes(stored);
  inspection.memory = memory_of(stored.map, inspection.counts);
  inspection.faults = find_faults(stored);
  return inspection;
}

}  // namespace byre
