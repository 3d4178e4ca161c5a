#include "byre/cli/shared/absent.h"
#include "byre/cli/shared/arguments.h"
#include "byre/cli/shared/live_input.h"

#include <stdexcept>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

std::string no_cameras() {
  return absence("live cameras", "linux-libc-dev", "BYRE_WITH_V4L2");
}

}  // namespace

bool LiveOptions::is_wanted() const {
  return false;
}

std::string LiveOptions::name() const {
  return "";
}

void declare_live_options(CLI::App& command, LiveOptions&, MethodArguments&) {
  declare_text(command.add_option_function<std::vector<std::string>>(
      "--live", [](const auto&) { throw CLI::ValidationError("--live", no_cameras()); },
      "Not available: " + no_cameras()));
}

LiveInput open_live(const LiveOptions&, const Calibration&, const std::string&,
                    std::function<void(const std::string& note)>) {
  throw std::runtime_error("--live: " + no_cameras());
}

}  // namespace byre::cli
