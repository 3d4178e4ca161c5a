#include "byre/simulation/cowshed/cowshed_rendering.h"

#include "byre/input_error.h"

#include <chrono>

namespace byre {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

void require_no_recording(const fs::path& folder) {
  if (!fs::exists(folder / "mav0")) return;
  throw InputError(folder.string(), "already contains a recording",
                   "choose another folder, or remove the existing one first");
}

// Removes an incomplete recording.
void remove_recording(const fs::path& folder) {
  fs::remove_all(folder / "mav0");
  fs::remove_all(folder / "plan");
}

}  // namespace

Rendering render_cowshed(const CowshedRecordingOptions& options, const fs::path& folder, const RenderingHooks& hooks) {
  require_no_recording(folder);
  const auto begin = Clock::now();
  CowshedRecording recording(options);
  Rendering rendering{.frames = static_cast<int>(recording.times().size()), .preparing_s = seconds_since(begin)};
  hooks.before_frames(rendering.frames);
  const auto built = Clock::now();
  write_cowshed_recording(recording, folder, [&](int done) {
    hooks.after_frame(done);
    return !hooks.should_stop();
  });
  rendering.rendering_s = seconds_since(built);
  rendering.stopped = hooks.should_stop();
  if (rendering.stopped) remove_recording(folder);
  return rendering;
}

}  // namespace byre
