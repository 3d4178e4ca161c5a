#include "byre/base/report_row.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/outputs.h"
#include "byre/playback/archive/colmap_export.h"

#include <memory>
#include <ostream>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct ExportCommandOptions {
  fs::path map;
  fs::path model;
  std::vector<fs::path> recordings;
  OpenOptions open;
  bool text = false;
  bool binary = false;  // the default, made explicit
};

constexpr const char* kExportColmapFooter = R"(Examples:
  byre export-colmap barn.byre -o model
  byre export-colmap barn.byre -o model --text --images-of MH_01_easy

The model contains the unrectified left images with their lens model; in COLMAP's programs give their folder as the
image path (mav0/cam0/data of a EuRoC recording). The model format has no disparities, descriptors or covariances;
points whose depth comes from the disparity of a single image are left out.)";

ExitCode run_export(const ExportCommandOptions& options, std::ostream& result) {
  const StoredMap stored = load_map(options.map);
  ImageNames names;
  for (const fs::path& recording : options.recordings) names.merge(names_of_images(recording, options.open));
  const ColmapModel model = colmap_model_of(stored, names);
  make_folder(options.model);
  write_colmap_model(model, options.model, options.text ? ColmapFormat::text : ColmapFormat::binary);
  result << row("written", fmt::format("{} cameras, {} images, {} points to {}", model.cameras.size(),
                                       model.images.size(), model.points.size(), options.model.string()))
         << row("skipped",
                fmt::format("{} points seen by one image only", stored.map.point_count() - model.points.size()));
  return ExitCode::done;
}

}  // namespace

Action declare_export_colmap(CLI::App& command) {
  const auto options = std::make_shared<ExportCommandOptions>();
  add_input(command, Input::file, "MAP", options->map, "Map file of \"byre map -o\"")->required();
  add_output(command, Output::colmap_model, "-o,--output", options->model,
             "Folder for cameras, images and points3D, created if missing")
      ->required();
  add_input(command, Input::recording, "--images-of", options->recordings,
            "Recordings whose file names are used for the images (default: <nanoseconds>.png)")
      ->type_name("FOLDER...");
  declare_open_options(command, options->open);
  auto* const text = command.add_flag("--text", options->text, "Write the text format");
  command.add_flag("--binary", options->binary, "Write the binary format (the default)")->excludes(text);
  command.footer(kExportColmapFooter);
  return [options](std::ostream& result) { return run_export(*options, result); };
}

}  // namespace byre::cli
