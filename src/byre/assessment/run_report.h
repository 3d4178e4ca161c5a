#pragma once

#include "byre/assessment/map_statistics.h"
#include "byre/assessment/mission_report.h"
#include "byre/playback/map_run.h"
#include "byre/system/resources.h"

#include <optional>
#include <string>
#include <vector>

namespace byre {

// How a run was made; without it its figures cannot be compared with others.
struct MapProtocol {
  std::string recording;
  std::optional<RecordingFormat> format = RecordingFormat::euroc;  // empty: live cameras
  CameraChoice camera = CameraChoice::stereo;
  FrameRange range;
  int frames_in_range = 0;
  TimeCorrections times;  // differences between frame times and recorded stamps
  EngineOptions options;
  std::string extended;                  // the map that was gone on with; empty for none
  std::vector<std::string> recordings;   // recordings of the whole map
  std::string offline;                   // the map of a mission; empty for none
  std::optional<PlanRegistration> plan;  // plan that the map lies on and poses are given in; empty: in the map's frame
  std::string program = "byre map";
  bool is_metric = true;  // false for one camera that maps from nothing: lengths are in units of the map's own
};

// Everything known about the run: protocol, figures, and an array with an object for each frame, one a line. With a
// mission also what that came to.
std::string to_json(const MapRun& run, const MapProtocol& protocol, const ResourceUse& resources,
                    const std::optional<MissionOutcome>& mission = {});

// A page for people, about the map, or with a mission about that. The files are those that were written.
std::string to_text(const MapRun& run, const MapProtocol& protocol, const ResourceUse& resources,
                    const std::vector<std::string>& files, const std::optional<MissionOutcome>& mission = {});

// Throws std::runtime_error, with the first warning and a remedy, if so many frames could not be read that the result
// does not represent the recording (is_full_of_gaps).
void require_frames(int unreadable, int frames, const std::vector<std::string>& warnings);
inline void require_frames(const MapRun& run) {
  const FrameCounts counts = count_frames(run.frames);
  require_frames(counts.unreadable, counts.frames, run.warnings);
}

// Throws std::runtime_error, which says why, when no frame got a pose.
void require_poses(const MapRun& run, const MapProtocol& protocol);

}  // namespace byre
