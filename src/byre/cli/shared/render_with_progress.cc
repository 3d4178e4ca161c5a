#include "byre/cli/shared/render_with_progress.h"

#include "byre/base/stopwatch.h"

#include <iostream>
#include <optional>

namespace byre::cli {

Rendering render_with_progress(const CowshedRecordingOptions& options, const std::filesystem::path& folder,
                               const InterruptCatcher& interrupt, bool quiet) {
  std::optional<Progress> progress;
  Stopwatch watch;
  RenderingHooks hooks;
  hooks.before_frames = [&](int frames) {
    progress.emplace(std::cerr, progress_style(quiet), frames);
    watch = {};
  };
  hooks.should_stop = [&interrupt] { return interrupt.caught(); };
  hooks.after_frame = [&](int done) { progress->update(done, watch.seconds(), "rendering"); };
  const Rendering rendering = render_cowshed(options, folder, hooks);
  progress->close();
  return rendering;
}

}  // namespace byre::cli
