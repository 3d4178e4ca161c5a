#pragma once

#include "byre/cli/interrupt.h"
#include "byre/slam/finishing.h"

namespace byre::cli {

// Finishing stops at Ctrl-C, and tells its steps on the standard error stream unless quiet. The catcher must outlive
// the hooks.
FinishHooks finish_hooks(const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
