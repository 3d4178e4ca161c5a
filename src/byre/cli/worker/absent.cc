#include "byre/cli/shared/absent.h"

namespace byre::cli {

Action declare_worker(CLI::App& command) {
  return declare_absent(command, "PostgreSQL client", "libpq-dev", "BYRE_WITH_LIBPQ");
}

}  // namespace byre::cli
