// Starts missions on a map at regular times of a recording, and counts wrongly trusted frames.
// Usage: byre_start_trials MISSION --map MAP --map-truth RECORDING [options]
//        byre_start_trials --case NAME [--calibration-seed N] [--from S] [--to S] [--trace FILE]
// MISSION is a recording with ground truth. MAP is an offline map of RECORDING, whose ground truth aligns it.
//   --every S          seconds between starts (0.5)
//   --length S         duration of each mission, seconds (11)
//   --from S --to S    first and last start, seconds of the recording
//   --camera C         stereo or left (stereo)
//   --no-wheels        without wheel.txt and gyroscope
//   --no-gyroscope     without gyroscope
//   --cover A:B        black images from A to B seconds after each start
//   --case NAME        case of start_cases.cc, whose recordings render_barns.sh renders; it makes its map
//   --calibration-seed N   calibration error of the cameras of a case (1)
//   --trace FILE       writes a line of CSV for each frame
// Found late: the map was in view for 3 s without a trusted pose. Features of each frame are extracted once. Exit code:
// 0 no wrongly trusted frames, 1 some, 2 bad usage or data.

#include "aligned_map.h"
#include "start_cases.h"
#include "start_run.h"

#include "byre/geometry/evaluation/map_frame_error.h"
#include "byre/input_error.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/map/keyframe_path.h"
#include "byre/recording.h"
#include "byre/slam/system/stored_map.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iostream>
#include <span>
#include <string_view>

#include <fmt/core.h>

namespace byre {
namespace {

struct StartOptions {
  std::string mission;
  std::string map;
  std::string map_recording;
  OpenOptions open{.use_wheels = true, .use_gyroscope = true};
  StartPlan plan;
  std::optional<std::string> trace;
  std::string start_case;
  std::uint64_t calibration_seed = 1;
};

std::optional<StartOptions> parse(std::span<char*> arguments) {
  StartOptions options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string argument = arguments[i];
    if (argument == "--no-wheels") {
      options.open.use_wheels = options.open.use_gyroscope = false;
      continue;
    }
    if (argument == "--no-gyroscope") {
      options.open.use_gyroscope = false;
      continue;
    }
    if (!argument.starts_with("--")) {
      options.mission = argument;
      continue;
    }
    if (i + 1 == arguments.size()) return std::nullopt;
    const std::string value = arguments[++i];
    const double number = std::atof(value.c_str());
    if (argument == "--map") {
      options.map = value;
    } else if (argument == "--map-truth") {
      options.map_recording = value;
    } else if (argument == "--every") {
      options.plan.every_s = number;
    } else if (argument == "--length") {
      options.plan.length_s = number;
    } else if (argument == "--from") {
      options.plan.from_s = number;
    } else if (argument == "--to") {
      options.plan.to_s = number;
    } else if (argument == "--camera") {
      if (value != "stereo" && value != "left") return std::nullopt;
      options.open.camera = value == "left" ? CameraChoice::left : CameraChoice::stereo;
    } else if (argument == "--case") {
      options.start_case = value;
    } else if (argument == "--calibration-seed") {
      options.calibration_seed = static_cast<std::uint64_t>(number);
    } else if (argument == "--trace") {
      options.trace = value;
    } else if (argument == "--cover" && value.find(':') != std::string::npos) {
      options.plan.cover_s = {number, std::atof(value.substr(value.find(':') + 1).c_str())};
    } else {
      return std::nullopt;
    }
  }
  if (!options.start_case.empty()) return options;
  const auto gyroscope = std::filesystem::path(options.mission) / "mav0" / "imu0" / "data.csv";
  options.open.use_gyroscope = options.open.use_gyroscope && std::filesystem::exists(gyroscope);
  if (options.mission.empty() || options.map.empty() || options.map_recording.empty()) return std::nullopt;
  return options;
}

void write_trace(std::ofstream& out, const StartedMission& trial, const Similarity& truth_from_map) {
  for (const MissionFrame& frame : trial.frames) {
    const FrameReport& report = frame.report;
    const Health& health = report.health;
    out << trial.start_s << ',' << to_seconds(report.time - trial.frames.front().report.time) << ','
        << report.time.count() << ',' << to_string(health.verdict) << ',' << to_string(health.doubt) << ','
        << position_error(frame, truth_from_map).value_or(-1.0) << ',' << health.position_sigma << ','
        << health.offline_expected << ',' << health.offline_inliers << ',' << health.online_inliers << ','
        << health.distance_since_offline << ',';
    for (const SessionEvent event : report.events) out << to_string(event) << ' ';
    out << '\n';
  }
}

void print_failure(const StartedMission& mission) {
  const MissionScore& score = mission.score;
  if (score.wrongly_trusted == 0 && !mission.is_localised_late) return;
  fmt::print(
      "  start {:.2f} s: {:.0f} % of {} frames trusted, {} of them wrong, worst {:.2f} m, first trusted after {}\n",
      mission.start_s, 100.0 * score.trusted, score.frames, score.wrongly_trusted, score.worst_trusted_error,
      score.recovery ? fmt::format("{:.1f} s", *score.recovery) : "never");
  std::fflush(stdout);
}

StartTotals run_case(const StartOptions& options, const std::function<void(const StartedMission&)>& each,
                     std::ofstream& trace) {
  const auto named = std::ranges::find(start_cases(), options.start_case, &StartCase::name);
  if (named == start_cases().end()) throw InputError(options.start_case, "is not a case", "see start_cases.cc");
  StartCase start_case = *named;
  if (const auto missing = what_is_missing(start_case)) throw InputError(start_case.name, "cannot be run", *missing);
  start_case.map.recipe.imperfection.calibration_seed = options.calibration_seed;
  start_case.plan.from_s = std::max(start_case.plan.from_s, options.plan.from_s);
  start_case.plan.to_s = std::min(start_case.plan.to_s, options.plan.to_s);
  const AlignedMap& known = MapCache().get(start_case.map);
  return run(start_case, known, [&](const StartedMission& mission) {
    if (trace.is_open()) write_trace(trace, mission, known.truth_from_map);
    each(mission);
  });
}

StartTotals run_recording(const StartOptions& options, const std::function<void(const StartedMission&)>& each,
                          std::ofstream& trace) {
  const auto map = load_offline_map(options.map, mission_vocabulary());
  const Similarity truth_from_map =
      align_to_truth(keyframe_path(map->map()), Scale::fixed, load_truth(options.map_recording)).truth_from_map;
  const auto recording = open_recording(options.mission, {}, options.open);
  const Imperfection exact{CameraCondition::exact};  // recordings contain their own imperfections
  return run_starts(*recording, load_truth(options.mission), map, truth_from_map, exact, options.plan,
                    [&](const StartedMission& mission) {
                      if (trace.is_open()) write_trace(trace, mission, truth_from_map);
                      each(mission);
                    });
}

int run_trials(const StartOptions& options) {
  std::ofstream trace;
  if (options.trace) trace.open(*options.trace);
  const StartTotals totals = options.start_case.empty() ? run_recording(options, print_failure, trace)
                                                        : run_case(options, print_failure, trace);
  fmt::print(
      "{} starts, {} frames: {:.1f} % with a pose, {} trusted and correct, {} trusted and wrong in {} starts (worst "
      "{:.2f} m); {} starts localised late\n",
      totals.starts, totals.frames, 100.0 * totals.with_pose / std::max(1, totals.frames), totals.correctly_trusted,
      totals.wrongly_trusted, totals.starts_wrongly_trusted, totals.worst_trusted_error, totals.localised_late);
  return totals.wrongly_trusted > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  const auto options = byre::parse({argv + 1, static_cast<std::size_t>(argc - 1)});
  if (!options) {
    std::cerr
        << "usage: byre_start_trials MISSION --map MAP --map-truth RECORDING [--every S] [--length S] [--from S]\n"
           "         [--to S] [--camera stereo|left] [--no-wheels] [--no-gyroscope] [--cover A:B]\n"
           "         [--trace FILE]\n"
           "       byre_start_trials --case NAME [--calibration-seed N] [--from S] [--to S] [--trace FILE]\n";
    return 2;
  }
  try {
    return byre::run_trials(*options);
  } catch (const byre::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
