#pragma once

#include "byre/cli/shared/interrupt.h"
#include "byre/playback/frame_source.h"
#include "byre/playback/play.h"

namespace byre::cli {

// Hooks that print finishing steps to stderr unless quiet, and stop at Ctrl-C. The catcher must outlive them.
FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet);

// play() with progress on stderr unless quiet; stopped by Ctrl-C. Calls after_frame, on_frame and on_map_update of
// more_hooks unless empty; the other hooks are set here.
RunResult play_with_progress(Slam& slam, Recording& recording, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet);
RunResult play_with_progress(Slam& slam, FrameSource& frames, const PlayHooks& more_hooks,
                             const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
