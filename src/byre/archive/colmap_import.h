#pragma once

#include "byre/dataset/colmap_model.h"
#include "byre/features/extract.h"
#include "byre/map/map_file.h"
#include "byre/slam/map_from_model.h"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct ColmapImportOptions {
  std::optional<double> metres_per_unit;  // metres per unit of the model; without it the map's scale is unknown
  Pose body_from_camera;                  // place of each camera on the body, the same for all
  ExtractOptions extract;
  ModelMapOptions map;
};

// How well an image of the model and its features fit together.
struct ImportedImage {
  std::string name;
  int features = 0;
  int points_in_model = 0;    // points that the image saw when the model was made
  int points_attached = 0;    // points of the map that a feature of the image shows now
  double median_error = 0.0;  // pixels, between measured features and projected points; references are not counted
};

struct ColmapImport {
  StoredMap stored;
  std::vector<ImportedImage> images;      // one per keyframe
  std::vector<std::uint64_t> colmap_ids;  // model's point that point n of the map is; those beyond are byre's own
  int points_in_model = 0;
  std::vector<std::string> warnings;
};

struct ColmapImportHooks {
  std::function<bool()> should_stop;  // asked before each image
  std::function<void(int done)> after_image;
};

// Makes an offline map of a model and its images, in the order of their times. Images that cannot be read, or are of
// another size than their camera's, are left out with a warning. Throws InputError for unsupported camera models, for
// poses that do not fit the points, and if no image can be used. model_name: name of the model in messages and in the
// map.
ColmapImport import_colmap(const ColmapModel& model, const std::string& model_name,
                           const std::filesystem::path& images_folder, const ColmapImportOptions& options,
                           const ColmapImportHooks& hooks);

// Rows of a report.
std::string to_text(const ColmapImport& imported);

// Time stamps for the images of these names: the numbers that they are, as nanoseconds ("1403715273262142976.png");
// where some are none, as many seconds as names come before in the alphabet.
std::vector<Timestamp> times_of_names(const std::vector<std::string>& names);

}  // namespace byre
