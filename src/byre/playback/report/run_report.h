#pragma once

#include "byre/playback/play.h"
#include "byre/playback/report/map_statistics.h"
#include "byre/playback/report/mission_report.h"
#include "byre/slam/system/resources.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// Protocol of a run, needed to compare its figures with others.
struct RunProtocol {
  std::string recording;
  std::optional<RecordingFormat> format = RecordingFormat::euroc;  // empty: live cameras
  CameraChoice camera = CameraChoice::stereo;
  FrameRange range;
  int frames_in_range = 0;
  TimeCorrections times;  // differences between frame times and recorded stamps
  MethodOptions options;
  std::string extended;  // map that the run extended; empty for none
  std::vector<std::string> recordings;
  std::string offline;
  std::optional<PlanRegistration> plan;  // plan in whose frame poses are given; empty: the map's frame
  std::string program = "byre map";
  bool is_metric = true;  // false for a monocular map from scratch, in arbitrary units
};

// Protocol and figures of a run on the map, or with mission on the mission.
Report run_report(const RunResult& run, const RunProtocol& protocol, const ResourceUsage& resources,
                  const std::optional<MissionOutcome>& mission = {});

// The figures, and an array with one object per frame, one a line.
std::string to_json(const Report& report, const RunResult& run, const std::optional<MissionOutcome>& mission = {});

// Throws std::runtime_error, with the first warning and a remedy, if too many frames were unreadable for the result to
// represent the recording (misses_too_many_frames).
void require_frames(int unreadable, int frames, const std::vector<std::string>& warnings);
inline void require_frames(const RunResult& run) {
  const FrameCounts counts = count_frames(run.frames);
  require_frames(counts.unreadable, counts.frames, run.warnings);
}

// Throws std::runtime_error with the reason if no frame has a pose.
void require_poses(const RunResult& run, const RunProtocol& protocol);

}  // namespace byre
