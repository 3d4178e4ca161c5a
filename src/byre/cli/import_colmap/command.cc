#include "byre/base/output_file.h"
#include "byre/base/printable.h"
#include "byre/base/stopwatch.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/playback/archive/colmap_import.h"
#include "byre/recording.h"
#include "byre/slam/system/stored_map.h"

#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct ImportCommandOptions {
  fs::path model;
  fs::path images;
  fs::path map;
  std::optional<double> scale;
  std::optional<fs::path> body_of;
  OpenOptions open;
  std::optional<fs::path> vocabulary;
  std::string site;
  bool model_points_only = false;
  bool quiet = false;
};

constexpr const char* kImportColmapFooter = R"(Examples:
  byre import-colmap sparse/0 images -o site.byre
  byre import-colmap sparse/0 images -o site.byre --scale 0.25 --site "Barn 2"

Every image of the model becomes a keyframe with its pose in the model. Corners of the images become features. A
point of the model is matched to the features near its projections that look alike; points with fewer than two features are
left out. Corners without a model point become additional points. The map has the unit of the model unless --scale
gives its length in metres.)";
ColmapImport run_with_progress(const ColmapModel& model, const ImportCommandOptions& options,
                               const InterruptCatcher& interrupt) {
  Progress progress(std::cerr, progress_style(options.quiet), static_cast<int>(model.images.size()));
  const Stopwatch watch;
  ColmapImportHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_image = [&](int done) { progress.update(done, watch.seconds(), "extracting"); };
  ColmapImportOptions import_options;
  import_options.metres_per_unit = options.scale;
  import_options.map.add_own_points = !options.model_points_only;
  if (options.body_of)
    import_options.body_from_camera = open_recording(*options.body_of, {}, options.open)->calibration().body_from_left;
  const std::string name = fs::weakly_canonical(options.model).string();
  ColmapImport imported = import_colmap(model, name, options.images, import_options, hooks);
  progress.close();
  return imported;
}

ExitCode run_import(const ImportCommandOptions& options, std::ostream& result) {
  require_writable(options.map);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  const ColmapModel model = read_colmap_model(options.model);

  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const ColmapImport imported = run_with_progress(model, options, interrupt);
  if (!options.quiet) show_warnings(std::cerr, imported.warnings);
  if (interrupt.caught()) return ExitCode::interrupted;  // no incomplete model
  save_for_missions(imported.stored, vocabulary, options.site, options.map);
  result << to_text(imported) << "map                " << printable(options.map.string()) << "\n";
  return ExitCode::done;
}

}  // namespace

Action declare_import_colmap(CLI::App& command) {
  const auto options = std::make_shared<ImportCommandOptions>();
  add_input(command, Input::colmap_model, "MODEL", options->model,
            "COLMAP model: folder with cameras, images and points3D, .bin or .txt")
      ->type_name("MODEL_DIR")
      ->required();
  add_input(command, Input::images, "IMAGES", options->images,
            "Folder of the images; their names in the model are relative to it")
      ->type_name("IMAGES_DIR")
      ->required();
  add_output(command, Output::map, "-o,--output", options->map, "The map")->type_name("FILE")->required();
  auto* const scale =
      command.add_option("--scale", options->scale, "Length of the model's unit (none: the map has no metric scale)")
          ->type_name("METRES")
          ->check(between(1e-9, 1e9));
  add_input(command, Input::recording, "--body-of", options->body_of,
            "Recording whose calibration gives the camera pose in the body (body = camera)")
      ->type_name("FOLDER")
      ->needs(scale);
  declare_open_options(command, options->open);
  command.add_flag("--model-points-only", options->model_points_only,
                   "Add no points for corners without a model point");
  add_text(command, "--site", options->site, "Name of the building, stored in the map")->type_name("TEXT");
  add_input(command, Input::file, "--vocabulary", options->vocabulary,
            "Vocabulary of the map's words (the built-in one)");
  command.add_flag("--quiet", options->quiet, "Show no progress and no warnings");
  command.footer(kImportColmapFooter);
  return [options](std::ostream& result) { return run_import(*options, result); };
}

}  // namespace byre::cli
