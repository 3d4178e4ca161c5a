#pragma once

#include "byre/cli/commands.h"
#include "byre/cli/map/options.h"

#include <iosfwd>

namespace byre::cli {

// "byre map --poses": map from externally estimated poses. Precondition: options.given_poses and options.map are set.
ExitCode run_posed_map(const MapOptions& options, std::ostream& result);

}  // namespace byre::cli
