#pragma once

#include "byre/cli/shared/progress.h"
#include "byre/simulation/cowshed/cowshed_rendering.h"

#include <filesystem>

namespace byre::cli {

// render_cowshed with progress on stderr unless quiet; stopped by Ctrl-C.
Rendering render_with_progress(const CowshedRecordingOptions& options, const std::filesystem::path& folder,
                               const InterruptCatcher& interrupt, bool quiet);

}  // namespace byre::cli
