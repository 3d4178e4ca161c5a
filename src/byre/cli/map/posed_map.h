#pragma once

#include "byre/cli/commands.h"
#include "byre/cli/map/options.h"

#include <iosfwd>

namespace byre::cli {

// "byre map --poses": a map of frames whose poses somebody else has found out. Precondition: options.given_poses and
// options.map are set.
ExitCode run_posed_map(const MapOptions& options, std::ostream& result);

}  // namespace byre::cli
