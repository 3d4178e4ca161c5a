#include "byre/base/output_file.h"
#include "byre/base/stopwatch.h"
#include "byre/calibration_file.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/options.h"
#include "byre/cli/shared/progress.h"
#include "byre/features/image_threads.h"
#include "byre/input_error.h"
#include "byre/io/bag/bag.h"
#include "byre/io/recording/frame_selection.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/place/map_words.h"
#include "byre/playback/localise_run.h"
#include "byre/playback/play.h"
#include "byre/playback/report/localisation_report.h"
#include "byre/site.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <iostream>
#include <memory>
#include <utility>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct LocaliseCommandOptions {
  fs::path map;
  std::vector<fs::path> inputs;
  FrameRange range;
  OpenOptions open;
  PoseFrame frame = PoseFrame::map;
  std::optional<fs::path> truth;
  std::optional<fs::path> map_truth;
  std::optional<fs::path> trajectory;
  std::optional<fs::path> vocabulary;
  bool json = false;
  bool quiet = false;
};

constexpr const char* kLocaliseFooter = R"(Examples:
  byre localise barn.byre evening_round --truth evening_round
  byre localise barn.byre MH_01_easy --frames 150:300 --trajectory found.txt
  byre localise barn.byre evening_round --camera right
  byre localise barn.byre walk.mp4 --calibration phone.yaml --stride 30
  byre localise barn.byre photo1.png photo2.png --json
  byre localise farm.yaml photo1.png --json

Each frame is localised in the whole map, without tracking and without prediction. Images are those of the left
camera of the map's first recording, unless --camera or --calibration is given. With truth, errors are in the map's
frame: the map, not the frames, is aligned to the truth by its keyframes where the truth covers them; for a map of
another recording also give the truth of that recording (--map-truth). The time of an image is in its name,
nanoseconds or decimal seconds; images without a time are one second apart. In a site of several maps a frame that fits
two of them is not found; --json names the map of each frame. Exit code 0 even if no frame is found.)";

bool is_recording(const fs::path& input) {
  return fs::is_directory(input) || is_video_file(input) || is_bag(input);
}

// Requires one recording, or existing images.
void require_inputs(const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    if (!fs::exists(input)) throw InputError(input.string(), "does not exist", "give a recording, or image files");
    if (inputs.size() > 1 && is_recording(input)) {
      throw InputError(input.string(), "is a recording and is given together with other inputs",
                       "localise one recording at a time, or only image files");
    }
  }
}

Calibration calibration_of_map(const StoredMap& stored, const fs::path& path) {
  if (!stored.recordings.empty()) return stored.recordings.front().calibration;
  throw InputError(path.string(), "does not contain the calibration of its camera, so images cannot be localised in it",
                   "give the calibration of the camera (--calibration FILE)");
}

// Camera of single images: from the named calibration, else that of the map.
Calibration camera_of_images(const LocaliseCommandOptions& options, const StoredMap& stored) {
  const fs::path source = options.open.calibration.value_or(options.map);
  const Calibration calibration = options.open.calibration ? read_calibration(source, options.open.right_calibration)
                                                           : calibration_of_map(stored, options.map);
  return choose_calibration({calibration, source.string(), source.string()}, {}, options.open.camera, source).cameras;
}

// One map, or those of a site, with words: name in the site, empty without a site, and content.
using GivenMaps = std::vector<std::pair<std::string, StoredMap>>;

GivenMaps open_maps(const LocaliseCommandOptions& options, const Vocabulary& vocabulary) {
  GivenMaps maps;
  const auto add = [&](const std::string& name, const fs::path& file) {
    add_words(maps.emplace_back(name, open_map(file)).second, vocabulary);
  };
  if (!is_site_file(options.map)) {
    add("", options.map);
    if (options.frame == PoseFrame::plan) require_plan(maps.front().second.plan, options.map);
    return maps;
  }
  if (options.frame == PoseFrame::plan || options.truth) {
    throw InputError(options.map.string(), "is a site, and --truth and --frame plan are of one map", "give one map");
  }
  for (const SiteMap& map : read_site(options.map).maps) add(map.name, map.map);
  return maps;
}

std::pair<LocaliseRun, LocaliseProtocol> localise_all(const LocaliseCommandOptions& options, const GivenMaps& given,
                                                      const Vocabulary& vocabulary, const InterruptCatcher& interrupt) {
  const StoredMap& stored = given.front().second;
  std::vector<SearchableMap> maps;
  maps.reserve(given.size());
  for (const auto& [name, map] : given) maps.emplace_back(map, vocabulary, name);
  std::unique_ptr<Recording> recording;
  if (is_recording(options.inputs.front())) {
    recording = open_recording(options.inputs.front(), options.range, options.open);
    if (!options.quiet) show_warnings(std::cerr, recording->warnings());
  }
  const int frames = recording ? recording->size() : static_cast<int>(options.inputs.size());
  Progress progress(std::cerr, progress_style(options.quiet), frames);
  const Stopwatch watch;
  LocaliseHooks hooks;
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&](int done, const LocalisedFrame& frame) {
    const bool is_found = frame.world_from_body.has_value();
    progress.update(done, watch.seconds(), is_found ? "found" : to_string(frame.localisation.failure),
                    is_found ? Tone::good : Tone::bad);
  };
  LocaliseRun run = recording ? localise_recording(maps, *recording, hooks)
                              : localise_images(maps, options.inputs, camera_of_images(options, stored), hooks);
  progress.close();
  LocaliseProtocol protocol{options.map.string(), recording ? options.inputs.front().string() : "images", frames};
  if (options.frame == PoseFrame::plan) protocol.plan = stored.plan;
  return {std::move(run), std::move(protocol)};
}

std::optional<LocalisationErrors> judge(const LocaliseCommandOptions& options, const LocaliseRun& run,
                                        const StoredMap& stored) {
  if (!options.truth) return std::nullopt;
  const Trajectory truth = load_truth(*options.truth);
  return errors_in_map(run, stored, options.map_truth ? load_truth(*options.map_truth) : truth, truth);
}

// In order of time, which may differ from the order of names; of equal times the first.
void write_found(const LocaliseRun& run, const std::optional<PlanRegistration>& plan, const fs::path& path) {
  Trajectory found;
  for (const LocalisedFrame& frame : run.frames) {
    if (frame.world_from_body) found.push_back({frame.time, *frame.world_from_body});
  }
  std::ranges::stable_sort(found, {}, &StampedPose::time);
  const auto repeated = std::ranges::unique(found, {}, &StampedPose::time);
  found.erase(repeated.begin(), repeated.end());
  write_trajectory(plan ? on_plan(std::move(found), *plan) : found, path);
}

ExitCode run_localise(const LocaliseCommandOptions& options, std::ostream& result) {
  require_inputs(options.inputs);
  if (options.trajectory) require_writable(*options.trajectory);
  const Vocabulary vocabulary = open_vocabulary(options.vocabulary);
  const GivenMaps maps = open_maps(options, vocabulary);

  limit_image_threads(1);
  const InterruptCatcher interrupt;
  const auto [run, protocol] = localise_all(options, maps, vocabulary, interrupt);
  if (!options.quiet) show_warnings(std::cerr, run.warnings);
  if (options.trajectory) write_found(run, protocol.plan, *options.trajectory);
  const std::optional<LocalisationErrors> errors = judge(options, run, maps.front().second);
  const Report report = localisation_report(run, protocol, errors);
  result << (options.json ? to_json(report, 1) : report.text);
  for (const auto& [name, stored] : maps) {
    if (const InputError* const damage = stored.map.damage()) throw InputError(*damage);
  }
  return interrupt.caught() ? ExitCode::interrupted : ExitCode::done;
}

void declare_inputs(CLI::App& command, LocaliseCommandOptions& options) {
  add_input(command, Input::file, "MAP", options.map, "Map file of \"byre map -o\", or site file")
      ->type_name("MAP|SITE")
      ->required();
  add_input(command, Input::recording, "INPUT", options.inputs,
            "Recording (EuRoC, KITTI odometry, TUM RGB-D, images, video), or image files")
      ->type_name("RECORDING|IMAGES...")
      ->required();
  declare_open_options(command, options.open);
  declare_frame_range(command, options.range);
  declare_pose_frame(command, options.frame);
  add_input(command, Input::recording, "--truth", options.truth,
            "True poses of the frames: a trajectory or a recording with truth")
      ->type_name("FILE|FOLDER");
  add_input(command, Input::recording, "--map-truth", options.map_truth,
            "True poses of the map's recording in the same frame, to align the map (those of --truth)")
      ->type_name("FILE|FOLDER")
      ->needs("--truth");
}

}  // namespace

Action declare_localise(CLI::App& command) {
  const auto options = std::make_shared<LocaliseCommandOptions>();
  declare_inputs(command, *options);
  add_output(command, Output::trajectory, "--trajectory", options->trajectory,
             "Write the estimated poses, in TUM format");
  declare_vocabulary_option(command, options->vocabulary);
  command.add_flag("--json", options->json, "Print the result as JSON, with every frame");
  command.add_flag("--quiet", options->quiet, "Show no progress");
  check_when_parsed(command, [options] { require_valid(options->range); });
  command.footer(kLocaliseFooter);
  return [options](std::ostream& result) { return run_localise(*options, result); };
}

}  // namespace byre::cli
