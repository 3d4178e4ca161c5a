#pragma once

#include "byre/features/extract.h"
#include "byre/io/colmap/colmap_model.h"
#include "byre/map/map_file.h"
#include "byre/slam/window/map_from_model.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct ColmapImportOptions {
  std::optional<double> metres_per_unit;  // empty: the map's scale is unknown
  Pose body_from_camera;                  // pose on the body, equal for all cameras
  ExtractOptions extract;
  ModelMapOptions map;
};

// Agreement of an image of the model with the features extracted from it.
struct ImportedImage {
  std::string name;
  int features = 0;
  int points_in_model = 0;    // points that the image observes in the model
  int points_attached = 0;    // points of the map matched to a feature of the image
  double median_error = 0.0;  // pixels, between features and projected points; without reference observations
};

struct ColmapImport {
  StoredMap stored;
  std::vector<ImportedImage> images;      // one per keyframe
  std::vector<std::uint64_t> colmap_ids;  // COLMAP's id of each point n of the map; further points are byre's own
  int points_in_model = 0;
  std::vector<std::string> warnings;
};

struct ColmapImportHooks {
  std::function<bool()> should_stop;  // called before each image
  std::function<void(int done)> after_image;
};

// Makes an offline map of a model and its images, in the order of their times. Images that cannot be read or differ in
// size from their camera are skipped with a warning. Throws InputError for unsupported camera models, for poses that do
// not fit the points, and if no image is usable. model_name: name of the model in messages and in the map.
ColmapImport import_colmap(const ColmapModel& model, const std::string& model_name,
                           const std::filesystem::path& images_folder, const ColmapImportOptions& options,
                           const ColmapImportHooks& hooks);

// Summary as lines of text.
std::string to_text(const ColmapImport& imported);

// Times of images: the numbers in their names as nanoseconds ("1403715273262142976.png"). Unless all are distinct
// numbers: the alphabetical rank as seconds.
std::vector<Timestamp> times_of_names(const std::vector<std::string>& names);

}  // namespace byre
