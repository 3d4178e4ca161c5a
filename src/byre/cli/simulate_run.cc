#include "byre/cli/simulate_run.h"

#include "byre/cli/progress.h"
#include "byre/input_error.h"
#include "byre/session/stopwatch.h"

#include <iostream>

namespace byre::cli {
namespace {

namespace fs = std::filesystem;

void require_no_recording(const fs::path& folder) {
  if (!fs::exists(folder / "mav0")) return;
  throw InputError(folder.string(), "already holds a recording", "name another folder, or remove that one first");
}

// A part of a recording is of no use to anybody.
void remove_recording(const fs::path& folder) {
  fs::remove_all(folder / "mav0");
  fs::remove_all(folder / "plan");
}

}  // namespace

Rendering render_cowshed(const CowshedRecordingOptions& options, const fs::path& folder,
                         const InterruptCatcher& interrupt, bool quiet) {
  require_no_recording(folder);
  const Stopwatch preparing;
  CowshedRecording recording(options);
  Rendering rendering{.frames = static_cast<int>(recording.times().size()), .preparing_s = preparing.seconds()};
  Progress progress(std::cerr, progress_style(quiet), rendering.frames);
  const Stopwatch watch;
  write_cowshed_recording(recording, folder, [&](int done) {
    progress.update(done, watch.seconds(), "rendering");
    return !interrupt.caught();
  });
  progress.close();
  rendering.rendering_s = watch.seconds();
  rendering.stopped = interrupt.caught();
  if (rendering.stopped) remove_recording(folder);
  return rendering;
}

}  // namespace byre::cli
