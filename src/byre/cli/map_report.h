#pragma once

#include "byre/cli/map_run.h"
#include "byre/cli/resources.h"

#include <string>
#include <vector>

namespace byre::cli {

// How a run was made; without it its figures cannot be compared with others.
struct MapProtocol {
  std::string recording;
  RecordingFormat format = RecordingFormat::euroc;
  FrameRange range;
  int frames_in_range = 0;
  MapRunOptions options;
  std::string extended;                 // the map that was gone on with; empty for none
  std::vector<std::string> recordings;  // of the whole map
};

// Everything known about the run: protocol, figures, and an array with an object for each frame, one a line.
std::string to_json(const MapRun& run, const MapProtocol& protocol, const ResourceUse& resources);

// A dozen lines for people. The files are those that were written.
std::string to_text(const MapRun& run, const MapProtocol& protocol, const ResourceUse& resources,
                    const std::vector<std::string>& files);

}  // namespace byre::cli
