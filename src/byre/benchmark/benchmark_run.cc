#include "byre/benchmark/benchmark_run.h"

#include "byre/benchmark/speed.h"
#include "byre/input_error.h"
#include "byre/io/recording/trajectory_input.h"
#include "byre/playback/scaled_recording.h"
#include "byre/slam/system/option_table.h"
#include "byre/slam/system/resources.h"
#include "byre/slam/system/stored_map.h"
#include "byre/trajectory_file.h"

#include <algorithm>
#include <cctype>
#include <map>
#include <set>
#include <utility>

#include <fmt/core.h>

namespace byre {
namespace {

namespace fs = std::filesystem;

// An available recording and its truth.
struct Source {
  fs::path folder;
  FrameRange range;
  OpenOptions open;
  Trajectory truth;

  ScaledRecording open_frames(bool has_map) const { return open_scaled(folder, range, open, has_map); }
};

using Sources = std::map<std::string, Source>;  // by recording name

std::vector<std::string> recordings_of(const BenchmarkCase& benchmark_case) {
  std::vector<std::string> names = {benchmark_case.recording};
  if (benchmark_case.map) names.push_back(*benchmark_case.map);
  return names;
}

std::vector<BenchmarkCase> chosen_cases(const BenchmarkProtocol& protocol, const std::vector<std::string>& only) {
  if (only.empty()) return protocol.cases;
  std::vector<BenchmarkCase> chosen;
  for (const std::string& name : only) {
    const auto found = std::ranges::find(protocol.cases, name, &BenchmarkCase::name);
    if (found == protocol.cases.end()) {
      std::string names;
      for (const BenchmarkCase& known : protocol.cases) names += (names.empty() ? "" : ", ") + known.name;
      throw InputError("--only " + name, "is not a case of " + protocol.name, "available cases: " + names);
    }
    chosen.push_back(*found);
  }
  return chosen;
}

// Reason why a case cannot run; empty when all data is present.
std::optional<SkippedCase> missing_data(const BenchmarkCase& benchmark_case, const BenchmarkProtocol& protocol,
                                        const fs::path& data) {
  for (const std::string& name : recordings_of(benchmark_case)) {
    const fs::path folder = data / protocol.recording(name).folder;
    if (!fs::exists(folder)) return SkippedCase{benchmark_case.name, folder.string() + " does not exist"};
  }
  return std::nullopt;
}

Source open_source(const BenchmarkRecording& recording, const fs::path& data) {
  Source source{data / recording.folder, recording.range, recording.open, {}};
  if (recording.open.calibration) source.open.calibration = data / *recording.open.calibration;
  source.open_frames(false);  // opened once for early error reports
  source.truth = load_truth(recording.truth ? data / *recording.truth : source.folder);
  for (StampedPose& sample : source.truth) sample.time += recording.truth_offset;
  return source;
}

// Throws InputError for a recording without metric scale, which missions need.
void require_metric(const Source& source) {
  if (source.open_frames(false).is_metric) return;
  throw InputError(source.folder.string(), "is of one camera, so its map has no metric scale, which missions need",
                   "make the map of a stereo recording with both cameras, or of one with depth");
}

Sources open_sources(const std::vector<BenchmarkCase>& cases, const BenchmarkProtocol& protocol, const fs::path& data) {
  Sources sources;
  for (const BenchmarkCase& benchmark_case : cases) {
    for (const std::string& name : recordings_of(benchmark_case)) {
      if (!sources.contains(name)) sources.emplace(name, open_source(protocol.recording(name), data));
    }
    if (benchmark_case.map) require_metric(sources.at(*benchmark_case.map));
  }
  return sources;
}

Trajectory truth_during(const Trajectory& truth, const Recording& recording) {
  Trajectory part;
  for (const StampedPose& sample : truth) {
    if (sample.time >= recording.times().front() && sample.time <= recording.times().back()) part.push_back(sample);
  }
  return part;
}

std::pair<RunResult, CostMeasures> play_and_time(Slam slam, Recording& recording, const PlayHooks& hooks) {
  const bool is_reset = reset_peak_memory();
  const double cpu_before = resource_usage().cpu_seconds;
  RunResult run = play(slam, recording, hooks);
  if (run.map_damage) throw InputError(*run.map_damage);
  CostMeasures cost;
  cost.cpu_seconds = resource_usage().cpu_seconds - cpu_before;
  if (is_reset) cost.peak_memory_mb = peak_memory_mb();
  return {std::move(run), cost};
}

class BenchmarkRunner {
 public:
  BenchmarkRunner(const BenchmarkProtocol& protocol, const BenchmarkOptions& options, const BenchmarkHooks& hooks)
      : protocol_(protocol), options_(options), hooks_(hooks) {}

  BenchmarkResult run() {
    std::vector<BenchmarkCase> cases = chosen_cases(protocol_, options_.only);
    std::erase_if(cases, [this](const BenchmarkCase& candidate) { return skip_without_data(candidate); });
    if (cases.empty()) {
      throw InputError(options_.data.string(), "contains none of the recordings of " + protocol_.name,
                       "give their folder (--data), or download them: see docs/how-to/benchmark.md");
    }
    sources_ = open_sources(cases, protocol_, options_.data);
    for (const BenchmarkCase& benchmark_case : cases) run_case(benchmark_case);
    result_.stopped = hooks_.should_stop();
    return std::move(result_);
  }

 private:
  bool skip_without_data(const BenchmarkCase& candidate) {
    const std::optional<SkippedCase> missing = missing_data(candidate, protocol_, options_.data);
    if (missing) skip(*missing);
    return missing.has_value();
  }

  void skip(const SkippedCase& skipped) {
    result_.skipped.push_back(skipped);
    hooks_.on_skipped(skipped);
  }

  void run_case(const BenchmarkCase& benchmark_case) {
    if (hooks_.should_stop()) return;
    const BuiltMap* const map = benchmark_case.map ? map_of(*benchmark_case.map) : nullptr;
    if (hooks_.should_stop()) return;
    if (benchmark_case.map && map == nullptr) {
      return skip({benchmark_case.name, "mapping failed for " + *benchmark_case.map + ": no frame got a pose"});
    }
    const Source& source = sources_.at(benchmark_case.recording);
    const auto recording = source.open_frames(map != nullptr).recording;
    result_.cases.push_back({benchmark_case,
                             {},
                             guess_format(source.folder),
                             truth_during(source.truth, *recording),
                             camera_of(*recording, source.open)});
    for (const Arm arm : benchmark_case.arms) run_arm(benchmark_case, arm, arm == Arm::no_map ? nullptr : map);
  }

  void run_arm(const BenchmarkCase& benchmark_case, Arm arm, const BuiltMap* map) {
    const Source& source = sources_.at(benchmark_case.recording);
    const ScaledRecording opened = source.open_frames(map != nullptr);
    Recording& recording = *opened.recording;
    const Trajectory true_path = opened.path_of(source.truth);
    RunTruth truth{true_path, {}, opened.is_metric ? Scale::fixed : Scale::free};
    if (map != nullptr) truth.map = map->alignment;
    const std::string what = benchmark_case.name + " " + std::string(name_of(arm));
    ArmResult result;
    result.arm = arm;
    for (int i = 0; i < protocol_.runs; ++i) {
      const SlamOptions slam = options_for(arm, i, source);
      const Calibration& calibration = recording.calibration();
      hooks_.before_run(what + fmt::format(", run {} of {}", i + 1, protocol_.runs), recording.size());
      const auto [run, cost] =
          play_and_time(map != nullptr ? Slam::on_map(calibration, map->file, slam) : Slam::mapping(calibration, slam),
                        recording, run_hooks());
      if (hooks_.should_stop()) return;
      write_trajectories(run, file_name_of(benchmark_case.name) + "." + std::string(name_of(arm)), i);
      if (i == 0) {
        result.final_trace = trace_of(run.final, truth);
        result.causal_trace = trace_of(run.causal, truth);
      }
      RunMeasures measures = evaluate_run(run, truth);
      measures.cost.peak_memory_mb = cost.peak_memory_mb;
      measures.cost.cpu_seconds = cost.cpu_seconds;
      result.runs.push_back({protocol_.seed_of_run(i), measures, run.warnings});
      keep(result);
    }
  }

  // Stores the runs of an arm so far.
  void keep(const ArmResult& result) {
    std::vector<ArmResult>& arms = result_.cases.back().arms;
    if (result.runs.size() > 1) arms.pop_back();
    arms.push_back(result);
    hooks_.after_run(result_);
  }

  // Built at the first call; null if that failed or was stopped.
  const BuiltMap* map_of(const std::string& name) {
    const auto made = std::ranges::find(result_.maps, name, &BuiltMap::recording);
    if (made != result_.maps.end()) return &*made;
    if (!failed_maps_.contains(name)) make_map(name);
    const auto now = std::ranges::find(result_.maps, name, &BuiltMap::recording);
    return now != result_.maps.end() ? &*now : nullptr;
  }

  void make_map(const std::string& name) {
    const Source& source = sources_.at(name);
    const auto recording = source.open_frames(false).recording;
    hooks_.before_run("map of " + name, recording->size());
    Slam slam = Slam::mapping(recording->calibration(), options_for(Arm::no_map, 0, source));
    RunResult run = play(slam, *recording, run_hooks());
    if (hooks_.should_stop()) return;
    if (run.final.empty()) {
      failed_maps_.insert(name);
      return;
    }
    BuiltMap made{name,
                  options_.output / (file_name_of(name) + ".byre"),
                  run.stored.map.keyframe_count(),
                  run.stored.map.point_count(),
                  align_to_truth(run.final, Scale::fixed, source.truth),
                  run.wall_seconds};
    save_for_missions(std::move(run.stored), *slam.impl().inputs().vocabulary, "", made.file);
    write_trajectories(run, file_name_of(name) + ".map", 0);
    result_.maps.push_back(std::move(made));
  }

  SlamOptions options_for(Arm arm, int run, const Source& source) const {
    MethodOptions method = options_.method;
    method.session.map_online = arm != Arm::localise_only;
    method.session.relocalise.seed = protocol_.seed_of_run(run);
    SlamOptions slam = slam_options(method);
    slam.recording = source_name(source.folder);
    slam.vocabulary = options_.vocabulary;
    slam.baseline = source.open.baseline;
    return slam;
  }

  PlayHooks run_hooks() const {
    PlayHooks hooks;
    hooks.should_stop = hooks_.should_stop;
    hooks.after_frame = hooks_.after_frame;
    return hooks;
  }

  void write_trajectories(const RunResult& run, const std::string& name, int index) const {
    const fs::path folder = options_.output / "trajectories";
    fs::create_directories(folder);
    const std::string run_name = name + fmt::format(".{}", index + 1);
    write_trajectory(run.final, folder / (run_name + ".final.txt"));
    write_trajectory(run.causal, folder / (run_name + ".causal.txt"));
  }

  // Constant after construction; borrowed.
  const BenchmarkProtocol& protocol_;
  const BenchmarkOptions& options_;
  const BenchmarkHooks& hooks_;

  Sources sources_;
  std::set<std::string> failed_maps_;
  BenchmarkResult result_;
};

}  // namespace

std::vector<RunMeasures> ArmResult::measures() const {
  std::vector<RunMeasures> measures;
  for (const BenchmarkRunResult& run : runs) measures.push_back(run.measures);
  return measures;
}

BenchmarkResult run_benchmark(const BenchmarkProtocol& protocol, const BenchmarkOptions& options,
                              const BenchmarkHooks& hooks) {
  return BenchmarkRunner(protocol, options, hooks).run();
}

std::string file_name_of(const std::string& name) {
  std::string result;
  for (const char character : name) {
    if (character == '*') {
      result += "-star";
    } else {
      const bool is_plain = std::isalnum(static_cast<unsigned char>(character)) != 0 || character == '_';
      result += is_plain ? character : '-';
    }
  }
  return result;
}

}  // namespace byre
