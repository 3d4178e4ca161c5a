#pragma once

#include "byre/cli/interrupt.h"
#include "byre/cli/map_run.h"
#include "byre/cli/view_options.h"
#include "byre/viewer/web_run.h"

#include <filesystem>
#include <memory>

namespace byre::cli {

// What the viewer tells of a run.
struct WatchedRun {
  std::filesystem::path recording;
  const Recording& opened;
  std::optional<std::filesystem::path> map;   // the offline map's file
  std::shared_ptr<const OfflineMap> offline;  // what is in it
};

// Tells its address on the standard error stream, quiet or not. Throws InputError when the port cannot be had or the
// plan cannot be read, and when the map was not registered on a plan.
std::unique_ptr<RunViewer> start_viewer(const ViewOptions& options, const WatchedRun& run);

// What hands each frame to the viewer.
std::function<void(const RunView& view)> shown_in(RunViewer& viewer);

// For pages to be looked at once the work is done: tells so on the standard error stream unless quiet, and returns upon
// Ctrl-C.
void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
