#pragma once

#include "byre/cli/shared/interrupt.h"
#include "byre/playback/frame_source.h"

#include <optional>

namespace byre::cli {

// Finishing stops at Ctrl-C, and tells its steps on the standard error stream unless quiet. The catcher must outlive
// the hooks.
FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet);

// run_map of a recording or of other frames, stopped by Ctrl-C, that tells on the standard error stream how far it is
// unless quiet. Of the hooks, after_frame, look and offer_map are called too unless empty; the others are set here.
MapRun run_with_progress(Recording& recording, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before = {});
MapRun run_with_progress(FrameSource& frames, const EngineOptions& options, const MapRunHooks& more_hooks,
                         const InterruptCatcher& interrupt, bool quiet, std::optional<Map> before = {});

}  // namespace byre::cli
