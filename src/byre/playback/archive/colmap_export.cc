#include "byre/playback/archive/colmap_export.h"

#include "byre/colmap.h"
#include "byre/input_error.h"
#include "byre/io/colmap/colmap_camera.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/io/recording/recording_index.h"
#include "byre/map/point_grey.h"
#include "byre/place/map_words.h"
#include "byre/playback/archive/colmap_import.h"
#include "byre/slam/system/stored_map.h"

#include <system_error>
#include <utility>
#include <vector>

namespace byre {
namespace {

// The camera of a keyframe's original image, and its pose relative to the rectified camera of the map.
struct OriginalCamera {
  const Camera& camera;
  Pose original_from_rectified;
};

OriginalCamera original_camera(const StoredMap& stored, const Keyframe& keyframe) {
  const Calibration& calibration = stored.recordings[static_cast<std::size_t>(keyframe.recording)].calibration;
  const Rig& rig = stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  return {calibration.left, inverse(calibration.body_from_left) * rig.body_from_camera};
}

std::uint32_t camera_id(int recording) {
  return static_cast<std::uint32_t>(recording) + 1;
}
std::uint32_t image_id(KeyframeId id) {
  return id.number + 1;
}
std::uint64_t point_id(PointId id) {
  return std::uint64_t{id.number} + 1;
}

// Original pixel of a rectified one. Empty if rounding puts a pixel of the border outside the original image.
std::optional<Eigen::Vector2d> original_pixel(const OriginalCamera& original, const Rig& rig,
                                              const Eigen::Vector2d& rectified_pixel) {
  return original.camera.project(original.original_from_rectified.rotation * rig.ray(rectified_pixel));
}

// Key points of an image in the model, and the key point of each feature.
struct ImageKeypoints {
  std::vector<ColmapKeypoint> keypoints;
  std::vector<std::optional<std::uint32_t>> of_feature;
};

bool has_two_views(const MapGraph& map, PointId id) {
  return map.observations(id).size() >= 2;
}

ImageKeypoints keypoints_of(const StoredMap& stored, const Keyframe& keyframe) {
  const OriginalCamera original = original_camera(stored, keyframe);
  const Rig& rig = stored.map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  ImageKeypoints result;
  for (std::size_t feature = 0; feature < keyframe.sightings.size(); ++feature) {
    const Sighting& sighting = keyframe.sightings[feature];
    const Eigen::Vector2f pixel =
        sighting.point ? sighting.pixel : keyframe.frame.features->keypoint(static_cast<int>(feature)).pixel;
    const auto shown = original_pixel(original, rig, pixel.cast<double>());
    result.of_feature.emplace_back();
    if (!shown) continue;
    result.of_feature.back() = static_cast<std::uint32_t>(result.keypoints.size());
    ColmapKeypoint keypoint{to_colmap_pixel(*shown), {}};
    if (sighting.point && has_two_views(stored.map, *sighting.point)) keypoint.point_id = point_id(*sighting.point);
    result.keypoints.push_back(keypoint);
  }
  return result;
}

std::string name_of(const Keyframe& keyframe, const ImageNames& names) {
  const auto name = names.find(keyframe.frame.time);
  return name != names.end() ? name->second : std::to_string(keyframe.frame.time.count()) + ".png";
}

double error_in_pixels(const MapGraph& map, const Keyframe& keyframe, const Sighting& sighting, const MapPoint& point) {
  const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  const Eigen::Vector3d point_in_camera = keyframe.camera_from_world * point.position_in_world;
  if (point_in_camera.z() <= 0.0) return 0.0;
  return (rig.project(point_in_camera).head<2>() - sighting.pixel.cast<double>()).norm();
}

// Black without a patch.
std::array<std::uint8_t, 3> colour_of(const MapGraph& map, const MapPoint& point) {
  const std::uint8_t grey = grey_of(map, point).value_or(0);
  return {grey, grey, grey};
}

ColmapPoint point_of(const MapGraph& map, PointId id, const std::map<KeyframeId, ImageKeypoints>& keypoints) {
  const MapPoint& point = *map.find_point(id);
  ColmapPoint result{point.position_in_world, colour_of(map, point), 0.0, {}};
  for (const Observation& seen : map.observations(id)) {
    const auto feature = static_cast<std::size_t>(seen.feature);
    const auto keypoint = keypoints.at(seen.keyframe).of_feature[feature];
    if (!keypoint) continue;
    const Keyframe& keyframe = *map.find_keyframe(seen.keyframe);
    result.error += error_in_pixels(map, keyframe, keyframe.sightings[feature], point);
    result.track.push_back({image_id(seen.keyframe), *keypoint});
  }
  if (!result.track.empty()) result.error /= static_cast<double>(result.track.size());
  return result;
}

}  // namespace

ColmapModel colmap_model_of(const StoredMap& stored, const ImageNames& names) {
  ColmapModel model;
  std::map<KeyframeId, ImageKeypoints> keypoints;
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    const Keyframe& keyframe = *stored.map.find_keyframe(id);
    const OriginalCamera original = original_camera(stored, keyframe);
    model.cameras.try_emplace(camera_id(keyframe.recording), colmap_camera(original.camera));
    keypoints[id] = keypoints_of(stored, keyframe);
    model.images[image_id(id)] = {name_of(keyframe, names), camera_id(keyframe.recording),
                                  original.original_from_rectified * keyframe.camera_from_world,
                                  keypoints[id].keypoints};
  }
  for (const PointId id : stored.map.point_ids()) {
    if (has_two_views(stored.map, id)) model.points[point_id(id)] = point_of(stored.map, id, keypoints);
  }
  return model;
}

ImageNames names_of_images(const std::filesystem::path& recording, const OpenOptions& options) {
  RecordingIndex index = index_recording(recording, options);
  const ExtraImages extra = extra_images_of(index);
  index = choose_camera(std::move(index), extra, options.camera, recording);
  ImageNames names;
  for (const FrameFiles& frame : index.frames) names[frame.time] = frame.left.filename().string();
  return names;
}

namespace fs = std::filesystem;

Map import_colmap(const fs::path& model, const fs::path& images, const std::optional<double>& metres_per_unit,
                  bool adds_points) {
  if (metres_per_unit && !(*metres_per_unit > 0.0 && *metres_per_unit < 1e9)) {
    throw InputError("metres_per_unit", "is not a positive length", "give the length of the model's unit in metres");
  }
  ColmapImportOptions options;
  options.metres_per_unit = metres_per_unit;
  options.map.add_own_points = adds_points;
  const std::string name = fs::weakly_canonical(model).string();
  ColmapImport imported =
      import_colmap(read_colmap_model(model), name, images, options, {[] { return false; }, [](int) {}});
  if (!imported.warnings.empty()) {
    throw InputError(images.string(), "does not contain all images of the model: " + imported.warnings.front(),
                     "give the image path of colmap");
  }
  imported.stored.notes["software"] = "byre " BYRE_VERSION;
  add_words(imported.stored, open_vocabulary({}));
  return Map(std::move(imported.stored));
}

void export_colmap(const Map& map, const fs::path& model, const std::optional<fs::path>& images_of) {
  const StoredMap& stored = map.stored();
  for (const KeyframeId id : stored.map.keyframe_ids()) {
    if (std::cmp_less(stored.map.find_keyframe(id)->recording, stored.recordings.size())) continue;
    throw InputError("map", "does not contain the calibrations of its cameras", "make the map again");
  }
  const ColmapModel exported = colmap_model_of(stored, images_of ? names_of_images(*images_of) : ImageNames{});
  std::error_code failed;
  fs::create_directories(model, failed);
  if (failed) throw InputError(model.string(), "cannot be created: " + failed.message(), "name another folder");
  write_colmap_model(exported, model, ColmapFormat::binary);
}

}  // namespace byre
