#pragma once

#include "byre/benchmark/measures.h"
#include "byre/benchmark/protocol.h"
#include "byre/playback/play.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace byre {

struct BenchmarkOptions {
  std::filesystem::path data;                       // folder of the recordings
  std::filesystem::path output;                     // folder for maps and trajectories
  std::vector<std::string> only;                    // names of cases; empty: all
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  MethodOptions method;                             // options of every run except seeds
};

// An offline map, built once for all cases on it.
struct BuiltMap {
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
  std::vector<std::string> warnings;
};

struct ArmResult {
  Arm arm = Arm::no_map;
  std::vector<BenchmarkRunResult> runs;
  std::vector<TracePoint> final_trace;   // final positions of the first run
  std::vector<TracePoint> causal_trace;  // causal positions of the first run

  std::vector<RunMeasures> measures() const;
};

struct CaseResult {
  BenchmarkCase what;
  std::vector<ArmResult> arms;
  RecordingFormat format = RecordingFormat::euroc;
  Trajectory truth;  // true poses during the recording
  CameraChoice camera = CameraChoice::stereo;
};

struct SkippedCase {
  std::string name;
  std::string reason;
};

struct BenchmarkResult {
  std::vector<BuiltMap> maps;
  std::vector<CaseResult> cases;
  std::vector<SkippedCase> skipped;
  bool stopped = false;  // should_stop returned true; a run in progress was discarded
};

struct BenchmarkHooks {
  std::function<bool()> should_stop;                                    // called before each frame
  std::function<void(const std::string& what, int frames)> before_run;  // "mh_02* hybrid, run 1 of 3"
  std::function<void(int done, const PlayedFrame& frame)> after_frame;
  std::function<void(const BenchmarkResult& so_far)> after_run;
  std::function<void(const SkippedCase& skipped)> on_skipped;
};

// Builds the required maps, then runs every case with every arm as often as the protocol requires. Skips cases without
// recording or map. Throws InputError before the first run if a requested case does not exist, no recording is present,
// or a recording is broken or has no right camera or truth.
BenchmarkResult run_benchmark(const BenchmarkProtocol& protocol, const BenchmarkOptions& options,
                              const BenchmarkHooks& hooks);

// A name made safe for file names: "mh_02*" becomes "mh_02-star".
std::string file_name_of(const std::string& name);

}  // namespace byre
