#pragma once

#include "byre/cli/shared/interrupt.h"
#include "byre/playback/frame_source.h"

#include <optional>

namespace byre::cli {

// Hooks that print finishing steps to stderr unless quiet, and stop at Ctrl-C. The catcher must outlive them.
FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet);

// run_map with progress on stderr unless quiet; stopped by Ctrl-C. Calls after_frame, on_frame and on_map_update of
// more_hooks unless empty; the other hooks are set here.
MapRun run_with_progress(Recording& recording, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before = {});
MapRun run_with_progress(FrameSource& frames, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before = {});

}  // namespace byre::cli
