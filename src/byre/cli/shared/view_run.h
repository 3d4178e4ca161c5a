#pragma once

#include "byre/cli/shared/progress.h"
#include "byre/playback/play.h"
#include "byre/playback/report/run_messages.h"
#include "byre/viewer/web/web_run.h"
#include "byre/viewer/web/web_server.h"

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace byre::cli {

// Options of the viewer.
struct ViewOptions {
  bool is_wanted = false;
  WebServerOptions server;
  std::optional<std::filesystem::path> plan;
  std::optional<double> stay_s;  // time after a run; infinity: until Ctrl-C; empty: infinity with a terminal, else 0
};

// The options must outlive the parsing of the command line.

// --view [PORT], --view-for, --bind and --plan of a command with a run.
void declare_run_viewer_options(CLI::App& command, ViewOptions& options);

// --port, --bind and --plan of a command without a run. plan: description of the plan.
void declare_viewer_options(CLI::App& command, ViewOptions& options, const std::string& plan);

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
