#pragma once

#include "byre/playback/play.h"
#include "byre/playback/report/map_statistics.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// Returns free memory to the system and resets the peak. False if the system denies it.
bool reset_peak_memory();

// Peak resident memory of the program since the last reset, or since its start. Empty if the system does not report it.
std::optional<double> peak_memory_mb();

// Counts instructions by perf_event_open(2) in this thread and in threads it starts later; user space only. Starts
// counting on construction.
class InstructionCounter {
 public:
  InstructionCounter();
  ~InstructionCounter();
  InstructionCounter(const InstructionCounter&) = delete;
  InstructionCounter& operator=(const InstructionCounter&) = delete;

  // Since construction. Empty if the machine has no such counter, as many virtual ones, or denies access
  // (kernel.perf_event_paranoid above 2).
  std::optional<std::uint64_t> count() const;

 private:
  int descriptor_ = -1;  // owned; negative: unavailable
};

// A stage of a frame: its name and its field of StageSeconds.
struct FrameStage {
  const char* name;
  const char* key;  // in JSON
  double StageSeconds::*seconds;
};

std::span<const FrameStage> frame_stages();  // in order; the last is the whole frame

struct SpeedCase {
  std::filesystem::path recording;
  FrameRange range;
  OpenOptions open;
  std::optional<std::filesystem::path> map;         // offline map of a mission; empty: plain SLAM
  std::optional<std::filesystem::path> vocabulary;  // empty: the vocabulary installed with byre
  MethodOptions method;
  int cores = 0;
};

struct SpeedMeasures {
  int frames = 0;
  int with_pose = 0;
  int keyframes = 0;
  int late = 0;                   // frames that missed their deadline, if there is one
  int without_online_points = 0;  // see FrameCounts, like the next
  int with_left_alone = 0;
  std::vector<Distribution> stages;  // one per frame_stages()
  Distribution jobs;
  std::optional<double> first_pose_seconds;  // wall time from opening recording and map to the first pose
  double wall_seconds = 0.0;
  double cpu_seconds = 0.0;                   // in all threads, including decoding and finishing
  std::optional<std::uint64_t> instructions;  // in all threads, user space; empty if unavailable
  std::optional<double> peak_memory_mb;       // peak resident memory of the program; empty if unavailable
};

// Runs once. A stopped run is measured up to the stop. Throws InputError when the recording or the map cannot be
// opened.
SpeedMeasures measure_speed(const SpeedCase& what, const PlayHooks& hooks);

// Markdown table of the run with the median mean frame time, with the range over all runs.
std::string speed_markdown(const SpeedCase& what, std::vector<SpeedMeasures> runs);

std::string speed_json(const SpeedCase& what, const std::vector<SpeedMeasures>& runs);  // all runs

}  // namespace byre
