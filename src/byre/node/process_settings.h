#pragma once

#include "byre/node/node_config.h"
#include "byre/node/node_log.h"

namespace byre {

// Keeps the program's memory from being paged out, and lets the calling thread, which is to run the node, go before
// those of other programs; threads that it begins do not. As the settings want it; what the system does not allow is
// told, and left alone.
void apply_process_settings(const NodeConfig& config, const NodeLog& log);

}  // namespace byre
