#include "byre/cli/shared/absent.h"

namespace byre::cli {

Action declare_camera(CLI::App& command) {
  return declare_absent(command, "live cameras", "linux-libc-dev", "BYRE_WITH_V4L2");
}

}  // namespace byre::cli
