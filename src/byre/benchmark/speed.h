#pragma once

#include "byre/assessment/map_statistics.h"
#include "byre/playback/map_run.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace byre {

// A stage of a frame: how it is called, and where its time is kept.
struct FrameStage {
  const char* name;
  const char* key;  // in JSON
  double StageSeconds::*seconds;
};

std::span<const FrameStage> frame_stages();  // in order; the last one is the whole frame

// What is run to measure its speed.
struct SpeedCase {
  std::filesystem::path recording;
  FrameRange range;
  OpenOptions open;
  std::optional<std::filesystem::path> map;  // the offline map of a mission; empty: plain SLAM
  EngineOptions engine;                      // with a vocabulary, without a map
  int cores = 0;                             // cores of the machine
};

// What one run cost.
struct SpeedMeasures {
  int frames = 0;  // frames that were processed
  int with_pose = 0;
  int keyframes = 0;              // keyframes that were made
  int late = 0;                   // frames that took longer than their deadline, where there is one
  int without_online_points = 0;  // see FrameCounts, as the next
  int with_left_alone = 0;
  std::vector<TimeSummary> stages;            // one for each of frame_stages()
  TimeSummary jobs;                           // mapping jobs
  std::optional<double> first_pose_seconds;   // wall time from opening recording and map to the first pose
  double wall_seconds = 0.0;                  // wall time of it all
  double cpu_seconds = 0.0;                   // seconds in all threads, decoding and finishing included
  std::optional<std::uint64_t> instructions;  // in all threads, outside the kernel; empty where they are not told
  std::optional<double> peak_memory_mb;       // most resident memory of the program; empty where it is not told
};

// Runs it once. A run that is stopped is measured as far as it came. Throws InputError when the recording or the map
// cannot be opened.
SpeedMeasures measure_speed(const SpeedCase& what, const MapRunHooks& hooks);

// A table in Markdown of the run whose mean frame time is the median, with the range of what several runs measured.
std::string speed_markdown(const SpeedCase& what, std::vector<SpeedMeasures> runs);

std::string speed_json(const SpeedCase& what, const std::vector<SpeedMeasures>& runs);  // every run

}  // namespace byre
