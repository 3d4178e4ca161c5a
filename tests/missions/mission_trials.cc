// Runs the missions that test the session's health, and prints a table row for each.
// Usage: byre_mission_trials [--list] [--trace FOLDER] [--dump FOLDER] [--imperfection exact|good|worn]
//                            [--calibration-seed N] [CASE...]
// Runs the named cases, by default all whose recordings are present.
//   --trace             writes a line of CSV per frame into FOLDER/CASE.csv
//   --dump              runs nothing; writes examples of degraded images into FOLDER as PNG
//   --imperfection      camera condition of all cases
//   --calibration-seed  calibration error of all cases
// Exit code: 0 all requirements are met, 1 some are not, 2 wrong usage or bad data.

#include "mission_case.h"

#include "byre/input_error.h"
#include "byre/recording.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string_view>

#include <fmt/core.h>
#include <opencv2/imgcodecs.hpp>

namespace byre {
namespace {

namespace fs = std::filesystem;

struct TrialOptions {
  bool list = false;
  std::optional<fs::path> trace;
  std::optional<fs::path> dump;
  std::optional<CameraCondition> condition;
  std::optional<std::uint64_t> calibration_seed;
  std::vector<std::string> cases;
};

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

std::optional<CameraCondition> camera_condition_of(std::string_view name) {
  for (const CameraCondition condition : {CameraCondition::exact, CameraCondition::good, CameraCondition::worn}) {
    if (to_string(condition) == name) return condition;
  }
  return std::nullopt;
}

std::optional<TrialOptions> parse(std::span<char*> arguments) {
  TrialOptions options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string_view argument = arguments[i];
    const bool has_value = i + 1 < arguments.size();
    if (argument == "--list") {
      options.list = true;
    } else if (argument == "--trace" && has_value) {
      options.trace = arguments[++i];
    } else if (argument == "--dump" && has_value) {
      options.dump = arguments[++i];
    } else if (argument == "--imperfection" && has_value) {
      options.condition = camera_condition_of(arguments[++i]);
      if (!options.condition) return std::nullopt;
    } else if (argument == "--calibration-seed" && has_value) {
      options.calibration_seed = whole_number(arguments[++i]);
      if (!options.calibration_seed) return std::nullopt;
    } else if (argument.starts_with("--")) {
      return std::nullopt;
    } else {
      options.cases.emplace_back(argument);
    }
  }
  return options;
}

std::vector<MissionCase> all_cases() {
  std::vector<MissionCase> cases = real_mission_cases();
  std::ranges::move(twin_mission_cases(), std::back_inserter(cases));
  std::ranges::move(sensor_fault_cases(), std::back_inserter(cases));
  return cases;
}

std::vector<MissionCase> chosen(const TrialOptions& options) {
  std::vector<MissionCase> cases = all_cases();
  for (const std::string& name : options.cases) {
    if (std::ranges::find(cases, name, &MissionCase::name) == cases.end()) {
      throw InputError(name, "is not a case", "list the cases with --list");
    }
  }
  std::erase_if(cases, [&](const MissionCase& mission_case) {
    return !options.cases.empty() && std::ranges::find(options.cases, mission_case.name) == options.cases.end();
  });
  for (MissionCase& mission_case : cases) {
    const Imperfection& own = mission_case.map.recipe.imperfection;
    mission_case = with_imperfection(mission_case, {options.condition.value_or(own.condition),
                                                    options.calibration_seed.value_or(own.calibration_seed)});
  }
  return cases;
}

void write_trace(const MissionRun& mission_run, const fs::path& file) {
  std::ofstream out(file);
  out << "frame,time_s,state,verdict,doubt,error_m,position_sigma_m,offline_expected,offline_matches,offline_inliers,"
         "online_inliers,inlier_share,spread,agreement_m,since_offline_m,brightness,contrast,sharpness,events\n";
  for (std::size_t i = 0; i < mission_run.frames.size(); ++i) {
    const FrameReport& report = mission_run.frames[i].report;
    const Health& health = report.health;
    const ImageCondition image = health.image.value_or(ImageCondition{});
    out << i << ',' << to_seconds(report.time - mission_run.frames.front().report.time) << ','
        << to_string(report.state) << ',' << to_string(health.verdict) << ',' << to_string(health.doubt) << ','
        << position_error(mission_run.frames[i], mission_run.truth_from_map).value_or(-1.0) << ','
        << health.position_sigma << ',' << health.offline_expected << ',' << health.offline_matches << ','
        << health.offline_inliers << ',' << health.online_inliers << ',' << health.inlier_share << ',' << health.spread
        << ',' << (health.agreement ? health.agreement->translation : -1.0) << ',' << health.distance_since_offline
        << ',' << image.brightness << ',' << image.contrast << ',' << image.sharpness << ',';
    for (const SessionEvent event : report.events) out << to_string(event) << ' ';
    out << '\n';
  }
  if (!out) throw InputError(file.string(), "cannot be written");
}

std::string formatted_seconds(double seconds) {
  return fmt::format("{:.2f}", seconds);
}

std::string recovery_of(const MissionScore& score) {
  return score.recovery ? formatted_seconds(*score.recovery) : "never";
}

void print_heading() {
  std::printf(
      "| case | recording | map's camera | mission's | frames | coverage %% | trusted %% | worst trusted error m | "
      "longest wrong trust s | wrongly trusted | time to doubt s | "
      "recovery s | RMSE mm | within 95 %% bound %% |\n|---|---|---|---|---|---|---|---|---|---|---|---|---|---|\n");
}

void print_row(const MissionCase& mission_case, const MissionScore& score) {
  std::printf("| %s | %s | %s | %s | %d | %.1f | %.1f | %.3f | %.2f | %d | %s | %s | %.1f | %.1f |\n",
              mission_case.name.c_str(), mission_case.recording.name.c_str(),
              name_of(mission_case.map.recipe.imperfection).c_str(), name_of(mission_case.imperfection).c_str(),
              score.frames, 100.0 * score.coverage, 100.0 * score.trusted, score.worst_trusted_error,
              score.longest_wrong_trust, score.wrongly_trusted,
              score.time_to_doubt ? formatted_seconds(*score.time_to_doubt).c_str() : "-", recovery_of(score).c_str(),
              1e3 * score.rmse, 100.0 * score.within_bound);
  std::fflush(stdout);
}

// Whether all requirements are met.
bool run_and_print(const MissionCase& mission_case, const TrialOptions& options, MapCache& maps) {
  if (const auto missing = missing_recording(mission_case)) {
    std::fprintf(stderr, "%s: skipped, %s\n", mission_case.name.c_str(), why_missing(*missing).c_str());
    return true;
  }
  const MissionRun mission_run = run_mission(mission_case, maps);
  print_row(mission_case, mission_run.score);
  if (options.trace) write_trace(mission_run, *options.trace / (mission_case.name + ".csv"));
  const std::vector<std::string> broken = unmet_requirements(mission_case, mission_run.score);
  for (const std::string& requirement : broken)
    std::fprintf(stderr, "%s: %s\n", mission_case.name.c_str(), requirement.c_str());
  return broken.empty();
}

void write_png(const Image& image, const fs::path& file) {
  const cv::Mat pixels(image.height, image.width, CV_8U, const_cast<std::uint8_t*>(image.pixels.data()));
  if (!cv::imwrite(file.string(), pixels)) throw InputError(file.string(), "cannot be written");
}

// Writes each case's image pairs at the start of the disturbance and at its full extent.
void dump(const MissionCase& mission_case, const fs::path& folder) {
  if (missing_recording(mission_case)) return;
  const auto recording = open_recording(*find(mission_case.recording), mission_case.range);
  const Degradation cameras = imperfect_cameras(mission_case.imperfection);
  int step = 0;
  for (const MissionStep& frame : mission_case.plan(recording->times()).steps) {
    if (!frame.disturb) continue;
    ++step;
    if (step != 1 && step != 3 && step != 12) continue;
    const ImageFrame images = cameras(frame.disturb(recording->read(frame.frame).value()), step);
    const std::string name = mission_case.name + "_" + std::to_string(step);
    write_png(images.left, folder / (name + "_left.png"));
    if (images.right) write_png(*images.right, folder / (name + "_right.png"));
  }
}

int run(const TrialOptions& options) {
  const std::vector<MissionCase> cases = chosen(options);
  for (const auto& folder : {options.trace, options.dump}) {
    if (folder) fs::create_directories(*folder);
  }
  if (options.list) {
    for (const MissionCase& mission_case : cases) std::printf("%s\n", mission_case.name.c_str());
    return EXIT_SUCCESS;
  }
  if (options.dump) {
    for (const MissionCase& mission_case : cases) dump(mission_case, *options.dump);
    return EXIT_SUCCESS;
  }
  MapCache maps;
  bool all_met = true;
  print_heading();
  for (const MissionCase& mission_case : cases) all_met = run_and_print(mission_case, options, maps) && all_met;
  return all_met ? EXIT_SUCCESS : EXIT_FAILURE;
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  const auto options = byre::parse({argv + 1, static_cast<std::size_t>(argc - 1)});
  if (!options) {
    std::fprintf(
        stderr,
        "usage: byre_mission_trials [--list] [--trace FOLDER] [--dump FOLDER] [--imperfection exact|good|worn]\n"
        "                           [--calibration-seed N] [CASE...]\n");
    return 2;
  }
  try {
    return byre::run(*options);
  } catch (const byre::InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
