#pragma once

#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/view_options.h"
#include "byre/playback/map_run.h"
#include "byre/viewer/web_run.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace byre::cli {

// What the viewer tells of a run.
struct WatchedRun {
  std::filesystem::path recording;
  const Recording& opened;
  std::optional<std::filesystem::path> map;   // the offline map's file
  std::shared_ptr<const OfflineMap> offline;  // what is in it
};

// Tells its addresses on the standard error stream, quiet or not. Throws InputError when the port cannot be had or the
// plan cannot be read, and when the map was not registered on a plan.
std::unique_ptr<RunViewer> start_viewer(const ViewOptions& options, const WatchedRun& run);

// What hands each frame to the viewer.
std::function<void(const RunView& view)> shown_in(RunViewer& viewer);

// Tells at which addresses a viewer can be opened, on the standard error stream.
void announce(const std::vector<std::string>& urls);

// Lets this program have as many files open at once as it may ask for, but no more than a thousand: so many connections
// that what it has to read and write is never short of them.
void allow_many_descriptors();

// For pages to be looked at: tells so on the standard error stream unless quiet, and returns upon Ctrl-C.
void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet);

// Serves the page once a run is over, for as long as the options say.
void serve_after_run(const ViewOptions& options, const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
