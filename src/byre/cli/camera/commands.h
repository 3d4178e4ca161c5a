#pragma once

#include "byre/cli/commands.h"

namespace byre::cli {

// The commands below "byre camera". Each declares its options, and gives the action to be called once the command line
// is parsed.
Action declare_camera_list(CLI::App& command);
Action declare_camera_show(CLI::App& command);
Action declare_camera_record(CLI::App& command);

}  // namespace byre::cli
