#pragma once

#include "byre/simulation/cowshed/cowshed_recording.h"

#include <filesystem>
#include <functional>

namespace byre {

struct Rendering {
  int frames = 0;  // stereo pairs
  double preparing_s = 0.0;
  double rendering_s = 0.0;
  bool stopped = false;  // should_stop returned true; the files were removed

  double frames_per_second() const { return frames / rendering_s; }
};

struct RenderingHooks {
  std::function<void(int frames)> before_frames;  // called once the barn is built
  std::function<bool()> should_stop;              // called after each frame
  std::function<void(int done)> after_frame;
};

// Renders a visit to the cowshed into a folder. Throws InputError when the folder already holds a recording or is not
// writable.
Rendering render_cowshed(const CowshedRecordingOptions& options, const std::filesystem::path& folder,
                         const RenderingHooks& hooks);

}  // namespace byre
