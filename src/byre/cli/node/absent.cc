#include "byre/cli/shared/absent.h"

namespace byre::cli {

Action declare_node(CLI::App& command) {
  return declare_absent(command, "ROS 2 node", "cyclonedds-dev and libsystemd-dev", "BYRE_WITH_CYCLONEDDS");
}

}  // namespace byre::cli
