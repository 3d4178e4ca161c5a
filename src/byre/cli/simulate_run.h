#pragma once

#include "byre/cli/interrupt.h"
#include "byre/simulation/cowshed_recording.h"

#include <filesystem>

namespace byre::cli {

// What rendering a recording came to.
struct Rendering {
  int frames = 0;  // stereo pairs
  double preparing_s = 0.0;
  double rendering_s = 0.0;
  bool stopped = false;  // by Ctrl-C: nothing is left of it

  double frames_per_second() const { return frames / rendering_s; }
};

// Renders a visit to the cowshed into a folder, telling on the standard error stream how far it is unless quiet. Throws
// InputError when the folder holds a recording already, or cannot be written.
Rendering render_cowshed(const CowshedRecordingOptions& options, const std::filesystem::path& folder,
                         const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
