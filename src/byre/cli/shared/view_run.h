#pragma once

#include "byre/cli/shared/interrupt.h"
#include "byre/cli/shared/view_options.h"
#include "byre/playback/play.h"
#include "byre/playback/report/run_messages.h"
#include "byre/viewer/web/web_run.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace byre::cli {

// Description of a run for the viewer.
struct WatchedRun {
  std::string name;
  const Calibration& calibration;
  int frames = 0;                             // zero: unknown
  Timestamp last_time{};                      // time of the last frame, if known
  std::optional<std::filesystem::path> map;   // file of the offline map
  std::shared_ptr<const OfflineMap> offline;  // its contents
};

// Shows a run in the viewer, and publishes it to Foxglove clients.
class WatchedRunViewer {
 public:
  // Prints its addresses to stderr, even if quiet. Throws InputError if the port is not available, the plan cannot be
  // read, or the map is not registered on a plan.
  WatchedRunViewer(const ViewOptions& options, const WatchedRun& run);

  // Call one of both after each frame, in order.
  void note(const RunView& view);                  // frame with readable images
  void note_unreadable(const PlayedFrame& frame);  // frame with unreadable images

  void finish(const RunResult& run);  // no more frames follow

 private:
  RunViewer viewer_;
  RunMessages messages_;  // uses the sink of viewer_
};

// Prints the addresses of a viewer to stderr.
void announce(const std::vector<std::string>& urls);

// Serves pages until Ctrl-C; prints this to stderr unless quiet.
void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet);

// Serves the page after a run, as long as the options require.
void serve_after_run(const ViewOptions& options, const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
