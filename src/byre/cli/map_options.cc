#include "byre/cli/map_options.h"

#include <charconv>
#include <map>
#include <set>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

constexpr double kLongest_s = 1e9;

constexpr const char* kFooter = R"(Examples:
  byre map MH_01_easy --trajectory out.txt
  byre map kitti/sequences/00 --trajectory out.txt --causal-trajectory causal.txt --stats stats.json
  byre map MH_01_easy --trajectory out.txt --start 10 --end 25.5 --stride 2
  byre map MH_01_easy --trajectory out.txt --pace live --quiet

inline runs mapping between the frames, paced beside them with the same result each time; both as fast as they can.
live feeds the frames at their own time stamps, none is dropped. Trajectories are of the body: EuRoC's is the IMU,
KITTI's the left camera. Ctrl-C stops after the current frame and still writes all files, then the exit code is 130.)";

std::optional<int> parse_index(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value < 0) return std::nullopt;
  return value;
}

void declare_files(CLI::App& command, MapOptions& options) {
  command
      .add_option("RECORDING", options.recording, "Folder of a stereo recording, as EuRoC or KITTI odometry has them")
      ->type_name("FOLDER")
      ->required();
  command.add_option("--trajectory", options.trajectory, "Final poses: as recomputed after the last frame. TUM format")
      ->type_name("FILE")
      ->required();
  command
      .add_option("--causal-trajectory", options.causal_trajectory,
                  "Causal poses: as published when their frames came. TUM format")
      ->type_name("FILE");
  command.add_option("--stats", options.stats, "Times, counts and every frame's report, as JSON")->type_name("FILE");
}

void declare_range(CLI::App& command, FrameRange& range) {
  command.add_option("--start", range.start_s, "Begin so long after the recording's first frame")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, kLongest_s).description(""));
  command.add_option("--end", range.end_s, "End before so long after the recording's first frame")
      ->type_name("SECONDS")
      ->check(CLI::Range(0.0, kLongest_s).description(""));
  const auto set_frames = [&range](const std::string& text) {
    const std::optional<FrameRange> frames = parse_frames(text);
    if (!frames) throw CLI::ValidationError("--frames", "\"" + text + "\" is no range of frames such as 0:150");
    range.first = frames->first;
    range.last = frames->last;
  };
  command
      .add_option_function<std::string>(
          "--frames", set_frames, "Frames of the recording, counted from 0, END exclusive; either may be left out")
      ->type_name("FIRST:END");
  command.add_option("--stride", range.stride, "Take every n-th frame of those")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000).description(""))
      ->capture_default_str();
}

void require_sense(const MapOptions& options) {
  const FrameRange& range = options.range;
  if (range.start_s && range.end_s && *range.start_s >= *range.end_s) {
    throw CLI::ValidationError("--start", "must be less than --end");
  }
  std::set<fs::path> files;
  for (const fs::path& file : options.outputs()) {
    if (!files.insert(fs::absolute(file).lexically_normal()).second) {
      throw CLI::ValidationError(file.string(), "is named for two outputs");
    }
  }
}

}  // namespace

std::vector<fs::path> MapOptions::outputs() const {
  std::vector<fs::path> files = {trajectory};
  if (causal_trajectory) files.push_back(*causal_trajectory);
  if (stats) files.push_back(*stats);
  return files;
}

void declare_map_options(CLI::App& command, MapOptions& options) {
  declare_files(command, options);
  declare_range(command, options.range);
  const std::map<std::string, Pace> paces = {
      {"inline", Pace::same_thread}, {"paced", Pace::paced}, {"live", Pace::live}};
  command.add_option("--pace", options.pace, "Where mapping runs and how fast frames are fed (paced)")
      ->type_name("inline|paced|live")
      ->transform(CLI::CheckedTransformer(paces).description(""));
  std::map<std::string, Refinement> refinements;
  for (const Refinement refinement : {Refinement::none, Refinement::stereo, Refinement::all}) {
    refinements.emplace(name_of(refinement), refinement);
  }
  command
      .add_option("--refine", options.refinement, "Matches refined in the image; less than all is for comparison (all)")
      ->type_name("none|stereo|all")
      ->transform(CLI::CheckedTransformer(refinements).description(""));
  command.add_flag("--quiet", options.quiet, "Show no progress and no warnings");
  command.parse_complete_callback([&options] { require_sense(options); });
  command.footer(kFooter);
}

std::optional<FrameRange> parse_frames(std::string_view text) {
  const std::size_t colon = text.find(':');
  if (colon == std::string_view::npos) return std::nullopt;
  const std::string_view first = text.substr(0, colon), end = text.substr(colon + 1);
  FrameRange range;
  if (!first.empty()) {
    const std::optional<int> index = parse_index(first);
    if (!index) return std::nullopt;
    range.first = *index;
  }
  if (end.empty()) return range;
  range.last = parse_index(end);
  if (!range.last || *range.last <= range.first) return std::nullopt;
  return range;
}

}  // namespace byre::cli
