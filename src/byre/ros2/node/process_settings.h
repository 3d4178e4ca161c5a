#pragma once

#include "byre/ros2/node/node_config.h"
#include "byre/ros2/node/node_log.h"

namespace byre {

// Locks the program's memory, and sets the real-time priority of the calling thread, but not of threads that it starts,
// according to the settings. Missing permissions are logged.
void apply_process_settings(const NodeConfig& config, const NodeLog& log);

}  // namespace byre
