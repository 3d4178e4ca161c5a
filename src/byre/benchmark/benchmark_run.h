#pragma once

#include "byre/benchmark/judge.h"
#include "byre/benchmark/protocol.h"
#include "byre/place/vocabulary.h"
#include "byre/playback/map_run.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct BenchmarkOptions {
  std::filesystem::path data;     // folder in which the recordings lie
  std::filesystem::path output;   // folder in which maps and trajectories are put
  std::vector<std::string> only;  // names of cases; all when empty
  EngineOptions engine;           // every run's, but for maps and seeds
};

// An offline map, made once for all cases on it.
struct MadeMap {
  std::string recording;
  std::filesystem::path file;
  int keyframes = 0;
  int points = 0;
  MapAlignment alignment;  // to the truth of its recording
  double wall_seconds = 0.0;
};

struct BenchmarkRunResult {
  std::uint64_t seed = 0;
  RunMeasures measures;
  std::vector<std::string> warnings;  // warnings of the recording
};

struct ArmResult {
  Arm arm = Arm::no_map;
  std::vector<BenchmarkRunResult> runs;
  std::vector<TracePoint> final_trace;   // way by final poses of the first run
  std::vector<TracePoint> causal_trace;  // way by causal poses of the first run

  std::vector<RunMeasures> measures() const;  // measures of each run
};

struct CaseResult {
  BenchmarkCase what;
  std::vector<ArmResult> arms;  // arms begun
  RecordingFormat format = RecordingFormat::euroc;
  Trajectory truth;  // true poses while the recording lasts
  CameraChoice camera = CameraChoice::stereo;
};

struct SkippedCase {
  std::string name;
  std::string reason;
};

struct BenchmarkResult {
  std::vector<MadeMap> maps;
  std::vector<CaseResult> cases;  // cases begun
  std::vector<SkippedCase> skipped;
  bool stopped = false;  // stopped by who was asked, between two runs or in one that was then left out
};

struct BenchmarkHooks {
  std::function<bool()> should_stop;                                    // asked before each frame
  std::function<void(const std::string& what, int frames)> before_run;  // "mh_02* hybrid, run 1 of 3"
  std::function<void(int done, const MappedFrame& frame)> after_frame;
  std::function<void(const BenchmarkResult& so_far)> after_run;
  std::function<void(const SkippedCase& skipped)> on_skipped;
};

// Makes the maps that are asked for, then every case with every arm as often as the protocol says. A case whose
// recording is not there, or on a map that cannot be made, is skipped. Throws InputError when a case to be run does not
// exist, none has its recording, or a recording is broken, has no right camera or no truth: before anything is run.
BenchmarkResult run_benchmark(const BenchmarkProtocol& protocol, const BenchmarkOptions& options,
                              const Vocabulary& vocabulary, const BenchmarkHooks& hooks);

// A name as a part of file names: "mh_02*" becomes "mh_02-star".
std::string file_name_of(const std::string& name);

}  // namespace byre
