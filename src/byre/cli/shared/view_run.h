#pragma once

#include "byre/assessment/run_messages.h"
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
  std::string name;
  const Calibration& calibration;
  int frames = 0;                             // zero: nobody knows how many there will be
  Timestamp last_time{};                      // time of the last frame, where that is known
  std::optional<std::filesystem::path> map;   // the offline map's file
  std::shared_ptr<const OfflineMap> offline;  // what is in it
};

// A run that is watched: in the viewer, and as messages of ROS by whoever speaks Foxglove's protocol.
class WatchedRunViewer {
 public:
  // Tells its addresses on the standard error stream, quiet or not. Throws InputError when the port cannot be had or
  // the plan cannot be read, and when the map was not registered on a plan.
  WatchedRunViewer(const ViewOptions& options, const WatchedRun& run);

  // One of both after each frame, in order.
  void note(const RunView& view);              // where its images could be read
  void note_unread(const MappedFrame& frame);  // where they could not

  void finish(const MapRun& run);  // no more frames will come

 private:
  RunViewer viewer_;
  RunMessages messages_;  // put where the viewer says
};

// Tells at which addresses a viewer can be opened, on the standard error stream.
void announce(const std::vector<std::string>& urls);

// For pages to be looked at: tells so on the standard error stream unless quiet, and returns upon Ctrl-C.
void serve_until_interrupted(const InterruptCatcher& interrupt, bool quiet);

// Serves the page once a run is over, for as long as the options say.
void serve_after_run(const ViewOptions& options, const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
