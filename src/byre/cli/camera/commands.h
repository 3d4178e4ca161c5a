#pragma once

#include "byre/cli/commands.h"

namespace byre::cli {

// Subcommands of "byre camera". Each declares its options; call the returned action after parsing.
Action declare_camera_list(CLI::App& command);
Action declare_camera_show(CLI::App& command);
Action declare_camera_record(CLI::App& command);

}  // namespace byre::cli
