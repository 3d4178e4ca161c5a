// Starts missions on a map at regular times of a recording, and counts frames that are trusted and wrong.
// Usage: byre_start_trials MISSION --map MAP --map-truth RECORDING [options]
// MISSION is a recording with ground truth. MAP is an offline map made from RECORDING, and is aligned by its ground
// truth.
//   --every S          seconds between starts (0.5)
//   --length S         duration of each mission, seconds (11)
//   --from S --to S    first and last start, seconds of the recording
//   --camera C         stereo or left (stereo)
//   --no-wheels        without wheel.txt and gyroscope
//   --cover A:B        black images from A to B seconds after each start
//   --trace FILE       writes a line of CSV for each frame
// Features of each frame are extracted once. Exit code: 0 without frames that are trusted and wrong, 1 with such
// frames, 2 bad usage or data.

#include "mission_score.h"

#include "byre/dataset/trajectory_input.h"
#include "byre/evaluation/map_frame_error.h"
#include "byre/features/extract.h"
#include "byre/features/image_threads.h"
#include "byre/input_error.h"
#include "byre/map/keyframe_path.h"
#include "byre/map/known_calibration.h"
#include "byre/recording.h"
#include "byre/system/engine.h"
#include "byre/system/stored_map.h"

#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <span>
#include <string_view>

namespace byre {
namespace {

struct StartOptions {
  std::string mission;
  std::string map;
  std::string map_recording;
  double every_s = 0.5;
  double length_s = 11.0;
  double from_s = 0.0;
  double to_s = 1e9;
  OpenOptions open{.use_wheels = true, .use_gyroscope = true};
  std::optional<std::pair<double, double>> cover_s;
  std::optional<std::string> trace;
};

std::optional<StartOptions> parse(std::span<char*> arguments) {
  StartOptions options;
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string argument = arguments[i];
    if (argument == "--no-wheels") {
      options.open.use_wheels = options.open.use_gyroscope = false;
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
      options.every_s = number;
    } else if (argument == "--length") {
      options.length_s = number;
    } else if (argument == "--from") {
      options.from_s = number;
    } else if (argument == "--to") {
      options.to_s = number;
    } else if (argument == "--camera") {
      if (value != "stereo" && value != "left") return std::nullopt;
      options.open.camera = value == "left" ? CameraChoice::left : CameraChoice::stereo;
    } else if (argument == "--trace") {
      options.trace = value;
    } else if (argument == "--cover" && value.find(':') != std::string::npos) {
      options.cover_s = {number, std::atof(value.substr(value.find(':') + 1).c_str())};
    } else {
      return std::nullopt;
    }
  }
  const auto gyroscope = std::filesystem::path(options.mission) / "mav0" / "imu0" / "data.csv";
  options.open.use_gyroscope = options.open.use_gyroscope && std::filesystem::exists(gyroscope);
  if (options.mission.empty() || options.map.empty() || options.map_recording.empty()) return std::nullopt;
  return options;
}

// Features of the frames of a recording; empty for frames that cannot be read.
std::vector<std::optional<Frame>> extract_all(Recording& recording, const Calibration& calibration) {
  limit_image_threads(1);
  Extractor extractor(calibration, {});
  std::vector<std::optional<Frame>> frames;
  for (int i = 0; i < recording.size(); ++i) {
    const auto images = recording.read(i);
    frames.push_back(images ? std::optional(extractor.extract(*images).frame) : std::nullopt);
  }
  return frames;
}

// The frame with a covered lens.
Frame covered(const Frame& frame) {
  Frame dark = frame;
  dark.features = std::make_shared<const Features>();
  if (dark.condition) dark.condition = ImageCondition{};
  return dark;
}

struct StartTrial {
  double start_s = 0.0;
  std::vector<MissionFrame> frames;
};

struct Mission {
  const StartOptions& options;
  Recording& recording;
  const std::vector<std::optional<Frame>>& frames;
  const Trajectory& truth;
  std::shared_ptr<const OfflineMap> map;
  const Vocabulary& vocabulary;
};

// Adds samples up to a time; leaves out those earlier than a quarter of a second before the first frame.
template <typename Sample, typename Add>
void feed(const std::vector<Sample>& samples, std::size_t& next, Timestamp begin, Timestamp until, Add add) {
  for (; next < samples.size() && samples[next].time <= until; ++next) {
    if (samples[next].time >= begin - std::chrono::milliseconds(250)) add(samples[next]);
  }
}

StartTrial run_from(const Mission& mission, int first) {
  EngineOptions options;
  options.pace = Pace::paced;
  options.vocabulary = mission.vocabulary;
  options.offline = mission.map;
  Engine engine(mission.recording.calibration(), options);
  const std::vector<Timestamp>& times = mission.recording.times();
  const MotionSamples& motion = mission.recording.motion();
  if (const auto& axes = motion.left_from_gyroscope) engine.tell_gyroscope_mounting(*axes);
  const Timestamp begin = times[static_cast<std::size_t>(first)];
  StartTrial trial{to_seconds(begin - times.front()), {}};
  std::size_t wheel = 0, velocity = 0, rate = 0, acceleration = 0;
  for (std::size_t i = static_cast<std::size_t>(first); i < times.size(); ++i) {
    const double seconds = to_seconds(times[i] - begin);
    if (seconds >= mission.options.length_s) break;
    if (!mission.frames[i]) continue;
    feed(motion.wheels, wheel, begin, times[i], [&](const auto& sample) { engine.tell_wheels(sample); });
    feed(motion.velocities, velocity, begin, times[i], [&](const auto& sample) { engine.tell_wheels(sample); });
    feed(motion.rates, rate, begin, times[i], [&](const auto& sample) { engine.tell_gyroscope(sample); });
    feed(motion.accelerations, acceleration, begin, times[i],
         [&](const auto& sample) { engine.tell_accelerometer(sample); });
    const auto& cover = mission.options.cover_s;
    const bool is_covered = cover && seconds >= cover->first && seconds < cover->second;
    const Frame frame = is_covered ? covered(*mission.frames[i]) : *mission.frames[i];
    trial.frames.push_back({engine.process(frame), pose_at(mission.truth, frame.time, std::chrono::milliseconds(60))});
  }
  return trial;
}

void write_trace(std::ofstream& out, const StartTrial& trial, const Similarity& truth_from_map) {
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

struct Totals {
  int starts = 0, frames = 0, posed = 0, trusted = 0, wrong = 0, starts_wrong = 0, trusted_right = 0, never = 0;
  double worst = 0.0;
};

int run(const StartOptions& options) {
  const Vocabulary vocabulary = open_vocabulary({});
  const auto map = load_offline_map(options.map, vocabulary);
  const Similarity truth_from_map =
      align_to_truth(keyframe_path(map->map()), Scale::fixed, load_truth(options.map_recording)).truth_from_map;
  const auto recording = open_recording(options.mission, {}, options.open);
  const Trajectory truth = load_truth(options.mission);
  const auto known = known_calibration(map->recordings(), recording->calibration());
  const auto frames = extract_all(*recording, known ? known->calibration : recording->calibration());
  const Mission mission{options, *recording, frames, truth, map, vocabulary};
  std::ofstream trace;
  if (options.trace) trace.open(*options.trace);
  Totals totals;
  double next = options.from_s;
  const std::vector<Timestamp>& times = recording->times();
  for (std::size_t i = 0; i < times.size(); ++i) {
    const double seconds = to_seconds(times[i] - times.front());
    if (seconds + 1e-6 < next || seconds > options.to_s) continue;
    next += options.every_s;
    const StartTrial trial = run_from(mission, static_cast<int>(i));
    if (trial.frames.empty()) continue;
    if (options.trace) write_trace(trace, trial, truth_from_map);
    const MissionScore scored = score(trial.frames, truth_from_map, trial.frames.front().report.time);
    const int trusted = static_cast<int>(scored.trusted * scored.frames + 0.5);
    ++totals.starts;
    totals.frames += scored.frames;
    totals.posed += static_cast<int>(scored.coverage * scored.frames + 0.5);
    totals.trusted += trusted;
    totals.wrong += scored.wrongly_trusted;
    totals.trusted_right += trusted - scored.wrongly_trusted;
    totals.starts_wrong += scored.wrongly_trusted > 0 ? 1 : 0;
    totals.never += trusted == 0 ? 1 : 0;
    totals.worst = std::max(totals.worst, scored.worst_trusted_error);
    if (scored.wrongly_trusted > 0 || !scored.recovery || *scored.recovery > 3.0) {
      std::printf("  start %.2f s: %d of %d frames trusted, %d of them wrong, worst %.2f m, first trusted after %s\n",
                  trial.start_s, trusted, scored.frames, scored.wrongly_trusted, scored.worst_trusted_error,
                  scored.recovery ? (std::to_string(*scored.recovery) + " s").c_str() : "never");
      std::fflush(stdout);
    }
  }
  std::printf(
      "%d starts, %d frames: %.1f %% with a pose, %.1f %% trusted, %d trusted and right, %d trusted and wrong in "
      "%d starts (worst %.2f m); %d starts never trusted\n",
      totals.starts, totals.frames, 100.0 * totals.posed / std::max(1, totals.frames),
      100.0 * totals.trusted / std::max(1, totals.frames), totals.trusted_right, totals.wrong, totals.starts_wrong,
      totals.worst, totals.never);
  return totals.wrong > 0 ? EXIT_FAILURE : EXIT_SUCCESS;
}

}  // namespace
}  // namespace byre

int main(int argc, char** argv) {
  const auto options = byre::parse({argv + 1, static_cast<std::size_t>(argc - 1)});
  if (!options) {
    std::cerr
        << "usage: byre_start_trials MISSION --map MAP --map-truth RECORDING [--every S] [--length S] [--from S]\n"
           "         [--to S] [--camera stereo|left] [--no-wheels] [--cover A:B] [--trace FILE]\n";
    return 2;
  }
  try {
    return byre::run(*options);
  } catch (const byre::InputError& error) {
    std::cerr << error.what() << '\n';
    return 2;
  }
}
