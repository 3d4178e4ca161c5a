#include "byre/base/printable.h"
#include "byre/cli/commands.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/progress.h"
#include "byre/cli/shared/render_with_progress.h"
#include "byre/playback/report/report.h"
#include "byre/simulation/camera_imperfection.h"
#include "byre/simulation/cowshed/barn_life.h"

#include <array>
#include <charconv>
#include <filesystem>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

struct SimulateOptions {
  CowshedRecordingOptions recording;
  std::optional<CameraCondition> condition{};                           // empty: exact
  std::vector<std::function<void(CameraImperfection&)>> camera_errors;  // differences from the condition
  fs::path output;
  bool has_motion = false;
  MotionSensorOptions motion;
  int visits = 60;          // number of visits of a life
  std::vector<int> only{};  // visits to render; empty: all
  bool json = false;
  bool quiet = false;
};

constexpr const char* kSimulateFooter = R"(Examples:
  byre simulate cowshed -o barn_1
  byre simulate cowshed --mission 2 -o barn_2
  byre simulate cowshed --mission 3 --time dusk --change 0.5 --cows 12 --dirt 1 --dust 0.5 -o barn_3
  byre simulate cowshed --imperfection good -o barn_4
  byre simulate cowshed --mission 2 --time day --light 0.03 --headlight 1 -o barn_7
  byre simulate cowshed --motion --turn spot -o barn_6
  byre simulate cowshed --tags 12 -o barn_8
  byre simulate cowshed --calibration-level 1 --calibration-seed 2 --rolling-shutter 15 -o barn_5

A feeding robot drives up and down the feed alley with a stereo camera. The same seed gives the same barn; another
mission is another visit to it: other feed, other light, other cows, a share of the buckets, pallets and barrows
moved, and an open gate to a store that was closed during the first visit.
FOLDER receives a EuRoC recording with exact truth (mav0), and a floor plan with points to register a map of this
recording (plan). With calibration errors, sensor.yaml contains them, and true_sensor.yaml is the calibration used
for rendering. With --motion it also receives the measurements of two driven wheels and a gyroscope (wheel.txt,
mav0/imu0), with their errors. The same options give the same bytes, for any number of threads. Ctrl-C leaves no
files. docs/reference/simulation.md describes the files and errors.)";

constexpr const char* kLifeFooter = R"(Examples:
  byre simulate life --motion --imperfection good -o life
  byre simulate life --visits 60 --only 1 2 3 --duration 30 --rate 8 --divide 2 -o life

FOLDER receives a recording for each day, day_01 to day_60, as of "byre simulate cowshed". Day 1 is the mapping run.
Things stay where the last visit left them; feed changes daily, tools are moved often. On two days of the week the
gate is open, and the drive 24 s longer. A third each of the visits is by day, at dusk, and by night with the
headlight. Dirt is wiped off at the end of a week, the eastern gable is painted in week five, a stall is built in
week seven, and the calibration error grows by half. A visit depends on the seed and its number only. Finished
recordings are kept: the same command goes on after Ctrl-C.)";

nlohmann::ordered_json imperfection_json(const CameraImperfection& camera) {
  return {{"calibration_level", camera.calibration_level},
          {"calibration_seed", camera.calibration_seed},
          {"rolling_shutter_s", camera.rolling_shutter_s},
          {"time_offset_s", camera.time_offset_s},
          {"lens_blur_px", camera.lens_blur},
          {"gain", camera.gain},
          {"offset", camera.offset},
          {"vignetting", camera.vignetting},
          {"jpeg_quality", camera.jpeg_quality}};
}

Report simulate_report(const SimulateOptions& options, const Rendering& rendering) {
  Report report{{{"program", "byre simulate"},
                 {"version", BYRE_VERSION},
                 {"scene", "cowshed"},
                 {"recording", options.output.string()},
                 {"seed", options.recording.barn.seed},
                 {"mission", options.recording.barn.mission},
                 {"turn", options.recording.turn == TurnKind::spot ? "spot" : "arc"},
                 {"light", options.recording.night.light},
                 {"headlight", options.recording.night.headlight},
                 {"imperfection", imperfection_json(options.recording.camera)},
                 {"frames", rendering.frames},
                 {"preparing_s", rendering.preparing_s},
                 {"rendering_s", rendering.rendering_s}}};
  report.row(
      "rendered",
      "{frames} stereo pairs in {rendering_s:.1f} s ({rate:.1f} a second), after {preparing_s:.1f} s to build the "
      "barn",
      {{"rate", rendering.frames_per_second()}});
  report.row("recording", "{recording}");
  report.row("floor plan", "{plan}", {{"plan", (options.output / "plan").string()}});
  return report;
}

ExitCode run_simulate(const SimulateOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  const Rendering rendering = render_with_progress(options.recording, options.output, interrupt, options.quiet);
  if (rendering.stopped) return ExitCode::interrupted;
  const Report report = simulate_report(options, rendering);
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
}

ExitCode run_life(const SimulateOptions& options, std::ostream& result) {
  const InterruptCatcher interrupt;
  std::vector<int> visits = options.only;
  for (int visit = 1; options.only.empty() && visit <= options.visits; ++visit) visits.push_back(visit);
  int rendered = 0;
  for (const int visit : visits) {
    const fs::path folder = options.output / fmt::format("day_{:02}", visit);
    if (fs::exists(folder)) continue;
    fs::path unfinished = folder;
    unfinished += ".unfinished";
    fs::remove_all(unfinished);  // left by a run that was killed
    if (!options.quiet) std::cerr << folder.filename().string() << "\n";
    const Rendering rendering =
        render_with_progress(visit_of_life(options.recording, visit), unfinished, interrupt, options.quiet);
    if (rendering.stopped) {
      fs::remove_all(unfinished);
      return ExitCode::interrupted;
    }
    fs::rename(unfinished, folder);
    ++rendered;
  }
  Report report{{{"program", "byre simulate"},
                 {"version", BYRE_VERSION},
                 {"scene", "life"},
                 {"folder", options.output.string()},
                 {"seed", options.recording.barn.seed},
                 {"rendered", rendered},
                 {"kept", visits.size() - static_cast<std::size_t>(rendered)}}};
  report.row("rendered", "{rendered} visits; {kept} were there already");
  report.row("folder", "{folder}");
  result << (options.json ? to_json(report) : report.text);
  return ExitCode::done;
}

CLI::Option* add_seed(CLI::App& command, CowshedOptions& barn) {
  return command.add_option("--seed", barn.seed, "Seed of the barn")->type_name("N")->capture_default_str();
}

void declare_visit(CLI::App& command, CowshedRecordingOptions& options) {
  const std::map<std::string, BarnTime> times = {{"day", BarnTime::day}, {"dusk", BarnTime::dusk}};
  const std::map<std::string, BarnGate> gates = {{"closed", BarnGate::closed}, {"open", BarnGate::open}};
  CowshedOptions& barn = options.barn;
  add_seed(command, barn);
  command.add_option("--mission", barn.mission, "Number of the visit, counted from 1")
      ->type_name("N")
      ->check(between(1, 1'000'000))
      ->capture_default_str();
  const auto add_amount = [&command](const char* name, double& value, double most, const char* meaning) {
    command.add_option(name, value, meaning)->type_name("NUMBER")->check(between(0.0, most))->capture_default_str();
  };
  add_amount("--change", barn.change, 1.0, "Share of the movable objects moved since mission 1");
  add_amount("--dirt", options.dirt, 4.0, "Dirt on the lenses; 1: a dozen blurred spots");
  add_amount("--dust", barn.dust, 4.0, "Dust in the air; 1: half of the light is lost in 14 m");
  command.add_option("--time", barn.time, "Time of day (day; dusk in even missions)")
      ->type_name("day|dusk")
      ->transform(one_of(times));
  command
      .add_option("--gate", barn.gate,
                  "Gate of the feed store; the robot enters if it is open (closed in mission 1, open later)")
      ->type_name("open|closed")
      ->transform(one_of(gates));
  command.add_option("--tags", barn.tags, "Number of AprilTags on the columns, whose poses are in plan/tags.yaml")
      ->type_name("N")
      ->check(between(0, 12))
      ->capture_default_str();
  command.add_option("--first-tag", barn.first_tag, "Number of the first AprilTag; the others follow along the alley")
      ->type_name("N")
      ->check(between(0, 500))
      ->capture_default_str();
  command.add_option("--cows", barn.cows, "Number of cows (3 in mission 1, 8 later)")
      ->type_name("N")
      ->check(between(0, 40));
}

void declare_night(CLI::App& command, NightOptions& night) {
  command.add_option("--light", night.light, "Brightness of the barn, relative to that of day or dusk")
      ->type_name("SHARE")
      ->check(between(1e-6, 10.0))
      ->capture_default_str();
  command
      .add_option("--headlight", night.headlight, "Headlight of the robot; 1: as bright 3 m ahead as the lamps at dusk")
      ->type_name("NUMBER")
      ->check(between(0.0, 100.0))
      ->capture_default_str();
  const auto add_time = [&command](const char* name, double& value, const char* meaning) {
    return command.add_option(name, value, meaning)->type_name("SECONDS")->check(between(0.0, 36000.0));
  };
  CLI::Option* const out = add_time("--lights-out", night.lights_out, "Time at which the barn's light goes out");
  out->needs(add_time("--lights-on", night.lights_on, "Time at which the light is on again")->needs(out));
}

// Parses width and height. Throws CLI::ValidationError for other text.
std::array<int, 2> size_of(const std::string& text) {
  std::array<int, 2> size{};
  const char* const end = text.data() + text.size();
  const auto width = std::from_chars(text.data(), end, size[0]);
  const bool has_height = width.ec == std::errc{} && width.ptr != end && *width.ptr == 'x';
  const auto height = has_height ? std::from_chars(width.ptr + 1, end, size[1]) : width;
  if (!has_height || height.ec != std::errc{} || height.ptr != end) {
    throw CLI::ValidationError("--size",
                               "must be WIDTHxHEIGHT in pixels, such as 640x480, not \"" + printable(text) + "\"");
  }
  return size;
}

void declare_camera(CLI::App& command, CowshedRecordingOptions& options) {
  command.add_option("--duration", options.duration_s, "Duration of the drive")
      ->type_name("SECONDS")
      ->check(between(0.1, 36000.0))
      ->capture_default_str();
  const std::map<std::string, TurnKind> turns = {{"arc", TurnKind::arc}, {"spot", TurnKind::spot}};
  command
      .add_option("--turn", options.turn,
                  "Turns at the ends of the alley: arc into the adjacent lane, or on the spot (arc)")
      ->type_name("arc|spot")
      ->transform(one_of(turns));
  command
      .add_option("--start", options.start,
                  "Start of the drive as a share of the lap (0 in mission 1, a little more in later ones)")
      ->type_name("SHARE")
      ->check(between(0.0, 1.0));
  command.add_option("--rate", options.frame_rate_hz, "Stereo pairs per second")
      ->type_name("HZ")
      ->check(between(1.0, 200.0))
      ->capture_default_str();
  command.add_option("--divide", options.image_divisor, "Divisor of the image size: 752 x 480 pixels divided by N")
      ->type_name("N")
      ->check(between(1, 16))
      ->capture_default_str();
  command
      .add_option_function<std::string>(
          "--size", [&options](const std::string& text) { options.image_size = size_of(text); },
          "Image size in pixels, such as 640x480; the field of view stays")
      ->type_name("WxH")
      ->excludes("--divide");
  command.add_option("--threads", options.threads, "Number of rendering threads (0: all cores)")
      ->type_name("N")
      ->check(between(0, 256))
      ->capture_default_str();
}

// Option that changes a number of the cameras, in units of the help.
template <typename Number>
void add_camera_error(CLI::App& command, SimulateOptions& options, const char* name, Number CameraImperfection::*member,
                      CLI::Validator range, const char* unit, const char* meaning, Number per_unit = 1) {
  const auto keep = [&options, member, per_unit](Number number) {
    options.camera_errors.emplace_back([=](CameraImperfection& camera) { camera.*member = number * per_unit; });
  };
  command.add_option_function<Number>(name, keep, meaning)->type_name(unit)->check(range)->group("Camera errors");
}

void declare_imperfection(CLI::App& command, SimulateOptions& options) {
  std::map<std::string, CameraCondition> conditions;
  for (const CameraCondition condition : {CameraCondition::exact, CameraCondition::good, CameraCondition::worn}) {
    conditions.emplace(to_string(condition), condition);
  }
  command.add_option("--imperfection", options.condition, "Preset of all camera errors by age and use (exact)")
      ->type_name("exact|good|worn")
      ->transform(one_of(conditions))
      ->group("Camera errors");
  using Camera = CameraImperfection;
  constexpr double kSecondsPerMillisecond = 1e-3;
  add_camera_error(command, options, "--calibration-level", &Camera::calibration_level, between(0.0, 10.0), "NUMBER",
                   "Size of the calibration error: 1 for a good calibration, 3 for a worn camera");
  add_camera_error(command, options, "--calibration-seed", &Camera::calibration_seed, {}, "N",
                   "Seed of the calibration error (1)");
  add_camera_error(command, options, "--rolling-shutter", &Camera::rolling_shutter_s, between(0.0, 100.0), "MS",
                   "Rolling shutter: readout time of an image", kSecondsPerMillisecond);
  add_camera_error(command, options, "--time-offset", &Camera::time_offset_s, between(-100.0, 100.0), "MS",
                   "Delay of the right camera's exposure", kSecondsPerMillisecond);
  add_camera_error(command, options, "--lens-blur", &Camera::lens_blur, between(0.0, 5.0), "PX",
                   "Standard deviation of the blur in the corners of left images; 1.5 times as much in right images");
  add_camera_error(command, options, "--gain", &Camera::gain, between(0.25, 4.0), "NUMBER",
                   "Gain of the right camera relative to the left one");
  add_camera_error(command, options, "--offset", &Camera::offset, between(-50.0, 50.0), "GREY",
                   "Offset of the right camera, grey values");
  add_camera_error(command, options, "--vignetting", &Camera::vignetting, between(0.0, 0.9), "SHARE",
                   "Vignetting: share of the light lost in the corners");
  add_camera_error(command, options, "--jpeg", &Camera::jpeg_quality, between(1, 100), "QUALITY",
                   "Quality of JPEG compression, before images are stored as PNG");
}

void declare_motion(CLI::App& command, SimulateOptions& options) {
  MotionSensorOptions& motion = options.motion;
  CLI::Option* const flag = command.add_flag("--motion", options.has_motion, "Record wheel odometry and gyroscope too");
  command
      .add_option("--wheel-radius-error", motion.radius_error,
                  "Relative error of the wheel radius: wheels are smaller than assumed by this share")
      ->type_name("SHARE")
      ->check(between(-0.2, 0.2))
      ->needs(flag)
      ->capture_default_str();
  command.add_option("--wheel-slip", motion.slip, "Standard deviation of a wheel's path, as a share of it")
      ->type_name("SHARE")
      ->check(between(0.0, 1.0))
      ->needs(flag)
      ->capture_default_str();
  command.add_option("--lift-from", motion.lifted_from, "Time at which the left wheel leaves the ground and spins")
      ->type_name("SECONDS")
      ->check(between(0.0, 36000.0))
      ->needs(flag);
  command.add_option("--lift-to", motion.lifted_to, "Time at which the wheel touches the ground again")
      ->type_name("SECONDS")
      ->check(between(0.0, 36000.0))
      ->needs(flag);
}

void declare_life(CLI::App& command, SimulateOptions& options) {
  add_seed(command, options.recording.barn);
  command.add_option("--visits", options.visits, "Number of visits, one a day")
      ->type_name("N")
      ->check(between(1, 1000))
      ->capture_default_str();
  command.add_option("--only", options.only, "Render these visits only")->type_name("N")->check(between(1, 1000));
  command
      .add_option("--change", options.recording.barn.change,
                  "Share of the tools moved at each visit; of other objects a third of this share is moved")
      ->type_name("NUMBER")
      ->check(between(0.0, 1.0))
      ->capture_default_str();
}

// Options of both scenes.
void declare_rendering(CLI::App& command, SimulateOptions& options, const char* output) {
  declare_camera(command, options.recording);
  declare_imperfection(command, options);
  declare_motion(command, options);
  add_output(command, Output::folder, "-o,--output", options.output, output)->required();
  command.add_flag("--json", options.json, "Print the report as JSON");
  command.add_flag("--quiet", options.quiet, "Show no progress");
}

}  // namespace

Action declare_simulate(CLI::App& command) {
  const auto options = std::make_shared<SimulateOptions>();
  command.require_subcommand(1);
  CLI::App& cowshed = *command.add_subcommand("cowshed", "A barn with a feed alley, fences, cubicles and cows");
  declare_visit(cowshed, options->recording);
  declare_night(cowshed, options->recording.night);
  declare_rendering(cowshed, *options, "Folder for the recording");
  cowshed.footer(kSimulateFooter);
  CLI::App& life = *command.add_subcommand("life", "The same barn over two months, a recording for each day");
  declare_life(life, *options);
  declare_rendering(life, *options, "Folder for the recordings");
  life.footer(kLifeFooter);
  return [options, &life](std::ostream& result) {
    options->recording.camera = imperfection_of(options->condition.value_or(CameraCondition::exact));
    for (const auto& change : options->camera_errors) change(options->recording.camera);
    if (options->has_motion) options->recording.motion = options->motion;
    return life.parsed() ? run_life(*options, result) : run_simulate(*options, result);
  };
}

}  // namespace byre::cli
