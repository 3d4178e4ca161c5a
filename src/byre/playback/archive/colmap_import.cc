#include "byre/playback/archive/colmap_import.h"

#include "byre/base/text_file.h"
#include "byre/input_error.h"
#include "byre/io/colmap/colmap_camera.h"
#include "byre/io/image/image_file.h"
#include "byre/trajectory_error.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// Times and ids of the images, which become keyframes.
std::vector<std::pair<Timestamp, std::uint32_t>> images_by_time(const ColmapModel& model) {
  std::vector<std::string> names;
  for (const auto& [id, image] : model.images) names.push_back(image.name);
  const std::vector<Timestamp> times = times_of_names(names);
  std::vector<std::pair<Timestamp, std::uint32_t>> images;
  for (const auto& [id, image] : model.images) images.emplace_back(times[images.size()], id);
  std::ranges::sort(images);
  return images;
}

// Cameras with images, in order of appearance. Keeps only the last extractor: each is large, and each image may have a
// camera.
class Cameras {
 public:
  Cameras(const ColmapModel& model, const std::string& model_name, const ColmapImportOptions& options)
      : model_(model), model_name_(model_name), options_(options) {}

  int index_of(std::uint32_t id) {
    const auto [entry, is_new] = index_of_.try_emplace(id, static_cast<int>(calibrations_.size()));
    if (is_new) {
      const std::string place = model_name_ + ": camera " + std::to_string(id);
      calibrations_.push_back({camera_of(model_.cameras.at(id), place), {}, options_.body_from_camera});
      use(entry->second);
      rigs_.push_back(extractor_->rig());
    }
    return entry->second;
  }

  Frame extract(int index, const ImageFrame& image) {
    if (index != used_) use(index);
    return extractor_->extract(image).frame;
  }

  const std::vector<Calibration>& calibrations() const { return calibrations_; }
  const std::vector<Rig>& rigs() const { return rigs_; }

 private:
  void use(int index) {
    extractor_.emplace(calibrations_[static_cast<std::size_t>(index)], options_.extract);
    used_ = index;
  }

  const ColmapModel& model_;
  const std::string& model_name_;
  const ColmapImportOptions& options_;
  std::map<std::uint32_t, int> index_of_;
  std::vector<Calibration> calibrations_;
  std::vector<Rig> rigs_;
  std::optional<Extractor> extractor_;  // for the camera used_
  int used_ = -1;
};

// Empty, with a warning added, if the image cannot be read or has another size than its camera.
std::optional<Image> read_as_taken(const fs::path& path, const Camera& camera, std::vector<std::string>& warnings) {
  std::optional<Image> image = read_image(path);
  if (!image) {
    warnings.push_back(path.string() + ": is truncated or not an image, skipped");
    return std::nullopt;
  }
  if (image->width == camera.width && image->height == camera.height) return image;
  warnings.push_back(path.string() + fmt::format(": is of {} x {} pixels, its camera of {} x {}, skipped", image->width,
                                                 image->height, camera.width, camera.height));
  return std::nullopt;
}

// The model in byre's types, with COLMAP's ids of its images and points.
struct ConvertedModel {
  SfmModel model;
  std::vector<std::uint32_t> image_ids;
  std::vector<std::uint64_t> point_ids;
};

void extract_images(const ColmapModel& colmap, const fs::path& folder, double scale, Cameras& cameras,
                    const ColmapImportHooks& hooks, ConvertedModel& converted, std::vector<std::string>& warnings) {
  int done = 0;
  for (const auto& [time, id] : images_by_time(colmap)) {
    if (hooks.should_stop()) break;
    const ColmapImage& image = colmap.images.at(id);
    const int camera = cameras.index_of(image.camera_id);
    std::optional<Image> pixels =
        read_as_taken(folder / image.name, cameras.calibrations()[static_cast<std::size_t>(camera)].left, warnings);
    if (pixels) {
      Pose camera_from_world = image.camera_from_world;
      camera_from_world.translation *= scale;
      const Frame frame = cameras.extract(camera, {time, std::move(*pixels), std::nullopt});
      converted.model.images.push_back({frame, camera_from_world, camera});
      converted.image_ids.push_back(id);
    }
    hooks.after_image(++done);
  }
  converted.model.rigs = cameras.rigs();
}

void convert_points(const ColmapModel& colmap, double scale, ConvertedModel& converted) {
  std::map<std::uint32_t, int> index_of;
  for (std::size_t i = 0; i < converted.image_ids.size(); ++i) index_of[converted.image_ids[i]] = static_cast<int>(i);
  for (const auto& [id, point] : colmap.points) {
    ModelPoint made{scale * point.position_in_world, {}};
    for (const ColmapTrackEntry& entry : point.track) {
      const auto image = index_of.find(entry.image_id);
      if (image != index_of.end()) made.images.push_back(image->second);
    }
    converted.model.points.push_back(std::move(made));
    converted.point_ids.push_back(id);
  }
}

// Reprojection errors of a keyframe's features, pixels; without references, whose error is zero by definition.
std::vector<double> errors_of(const MapGraph& map, const Keyframe& keyframe, KeyframeId id) {
  const Rig& rig = map.rigs()[static_cast<std::size_t>(keyframe.rig)];
  std::vector<double> errors;
  for (const Sighting& sighting : keyframe.sightings) {
    if (!sighting.point) continue;
    const MapPoint& point = *map.find_point(*sighting.point);
    if (point.reference.keyframe == id) continue;
    const Eigen::Vector3d point_in_camera = keyframe.camera_from_world * point.position_in_world;
    errors.push_back((rig.project(point_in_camera).head<2>() - sighting.pixel.cast<double>()).norm());
  }
  return errors;
}

ImportedImage describe_image(const MapGraph& map, KeyframeId id, const ColmapImage& image) {
  const Keyframe& keyframe = *map.find_keyframe(id);
  std::vector<double> errors = errors_of(map, keyframe, id);
  std::ranges::sort(errors);
  ImportedImage described{image.name, keyframe.frame.features->size()};
  described.points_in_model = static_cast<int>(std::ranges::count_if(
      image.keypoints, [](const ColmapKeypoint& keypoint) { return keypoint.point_id.has_value(); }));
  described.points_attached = static_cast<int>(
      std::ranges::count_if(keyframe.sightings, [](const Sighting& sighting) { return sighting.point.has_value(); }));
  if (!errors.empty()) described.median_error = quantile(errors, 0.5);
  return described;
}

// Adds one recording per camera with images, so that each keeps its calibration.
void add_recordings(const std::vector<Calibration>& calibrations, const SfmModel& model, const std::string& model_name,
                    StoredMap& stored) {
  for (std::size_t camera = 0; camera < calibrations.size(); ++camera) {
    const auto is_its_own = [camera](const PosedFrame& image) { return image.rig == static_cast<int>(camera); };
    SourceRecording source{model_name, calibrations[camera], {}, {}};
    const auto first = std::ranges::find_if(model.images, is_its_own);
    if (first != model.images.end()) source.first_time = source.last_time = first->frame.time;
    for (const PosedFrame& image : model.images) {
      if (is_its_own(image)) source.last_time = std::max(source.last_time, image.frame.time);
    }
    stored.recordings.push_back(source);
  }
}

void require_content(const ColmapModel& model, const std::string& name) {
  const char* const remedy = "give the folder of a finished reconstruction";
  if (model.images.empty()) throw InputError(name, "is a model without images, so it cannot be imported", remedy);
  if (model.points.empty()) throw InputError(name, "is a model without points, so it cannot be imported", remedy);
}

// Reprojection error of each key point with a point, pixels; the image width for a point that does not project.
std::vector<double> reprojection_errors(const ColmapModel& model, const std::string& name) {
  std::map<std::uint32_t, Camera> cameras;
  std::vector<double> errors;
  for (const auto& [id, image] : model.images) {
    auto camera = cameras.find(image.camera_id);
    if (camera == cameras.end()) {
      const std::string place = name + ": camera " + std::to_string(image.camera_id);
      camera = cameras.emplace(image.camera_id, camera_of(model.cameras.at(image.camera_id), place)).first;
    }
    for (const ColmapKeypoint& keypoint : image.keypoints) {
      if (!keypoint.point_id) continue;
      const Eigen::Vector3d& position = model.points.at(*keypoint.point_id).position_in_world;
      const auto pixel = camera->second.project(image.camera_from_world * position);
      errors.push_back(pixel ? (to_colmap_pixel(*pixel) - keypoint.pixel).norm() : camera->second.width);
    }
  }
  return errors;
}

// Rejects a model whose poses and points are from different states of the reconstruction.
void require_agreement(const ColmapModel& model, const std::string& name) {
  constexpr double kLargestMedian = 8.0;  // pixels; a finished model has about 0.5
  constexpr double kShareOfWidth = 0.01;  // larger bound for large images
  std::vector<double> errors = reprojection_errors(model, name);
  if (errors.empty()) return;
  std::ranges::sort(errors);
  const double median = quantile(errors, 0.5);
  const auto width = static_cast<double>(model.cameras.begin()->second.width);
  if (median <= std::max(kLargestMedian, kShareOfWidth * width)) return;
  throw InputError(
      name,
      fmt::format("has inconsistent image poses and points: the median reprojection error is {:.0f} pixels", median),
      "export the model again; poses in frames.txt or frames.bin may be newer than those in images (colmap "
      "model_converter updates them)");
}

}  // namespace

ColmapImport import_colmap(const ColmapModel& model, const std::string& model_name, const fs::path& images_folder,
                           const ColmapImportOptions& options, const ColmapImportHooks& hooks) {
  require_content(model, model_name);
  require_agreement(model, model_name);
  const double scale = options.metres_per_unit.value_or(1.0);
  Cameras cameras(model, model_name, options);
  ColmapImport result;
  ConvertedModel converted;
  extract_images(model, images_folder, scale, cameras, hooks, converted, result.warnings);
  if (converted.image_ids.empty()) {
    throw InputError(images_folder.string(), "contains none of the model's images in the size of its cameras",
                     "give the image path of colmap");
  }
  convert_points(model, scale, converted);
  const ModelMap made = map_from_model(converted.model, options.map);
  result.stored.map = offline_copy(made.map);
  result.stored.scale = options.metres_per_unit ? MapScale::metric : MapScale::unknown;
  result.stored.pose_source = PoseSource::imported;
  add_recordings(cameras.calibrations(), converted.model, model_name, result.stored);
  result.points_in_model = static_cast<int>(model.points.size());
  for (const int point : made.model_points)
    result.colmap_ids.push_back(converted.point_ids[static_cast<std::size_t>(point)]);
  for (std::size_t i = 0; i < converted.image_ids.size(); ++i) {
    const KeyframeId id{Origin::offline, static_cast<std::uint32_t>(i)};
    result.images.push_back(describe_image(result.stored.map, id, model.images.at(converted.image_ids[i])));
  }
  return result;
}

std::vector<Timestamp> times_of_names(const std::vector<std::string>& names) {
  std::set<Timestamp> distinct;
  std::vector<Timestamp> times;
  for (const std::string& name : names) {
    const auto time = parse_nanoseconds(fs::path(name).stem().string());
    if (!time || !distinct.insert(*time).second) break;
    times.push_back(*time);
  }
  if (times.size() == names.size()) return times;
  times.clear();
  for (const std::string& name : names) {
    const auto before = std::ranges::count_if(names, [&name](const std::string& other) { return other < name; });
    times.push_back(std::chrono::seconds(before));
  }
  return times;
}

std::string to_text(const ColmapImport& imported) {
  std::vector<double> attached, errors;
  for (const ImportedImage& image : imported.images) {
    attached.push_back(image.points_attached);
    errors.push_back(image.median_error);
  }
  std::ranges::sort(attached);
  std::ranges::sort(errors);
  const MapGraph& map = imported.stored.map;
  std::string text = fmt::format("keyframes          {}\n", map.keyframe_count());
  text += fmt::format("points             {} of {} in the model, {} added by byre\n", imported.colmap_ids.size(),
                      imported.points_in_model, map.point_count() - imported.colmap_ids.size());
  if (attached.empty()) return text;
  text += fmt::format("points per image   median {:.0f}, min {:.0f}\n", quantile(attached, 0.5), attached.front());
  text += fmt::format("error per image    median {:.2f} pixels, max {:.2f}\n", quantile(errors, 0.5), errors.back());
  text += imported.stored.scale == MapScale::metric ? "scale              metres\n"
                                                    : "scale              of the model (metric with --scale)\n";
  return text;
}

}  // namespace byre
