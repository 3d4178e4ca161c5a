#include "byre/colmap.h"

#include "byre/base/output_file.h"
#include "byre/input_error.h"
#include "byre/place/map_words.h"
#include "byre/playback/archive/colmap_export.h"
#include "byre/playback/archive/colmap_import.h"
#include "byre/slam/system/stored_map.h"

#include <system_error>
#include <utility>

namespace byre {

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
