#include "byre/cli/shared/absent.h"

namespace byre::cli {

Action declare_simulate(CLI::App& command) {
  return declare_absent(command, "ray tracing", "libembree-dev", "BYRE_WITH_EMBREE");
}

}  // namespace byre::cli
