#include "byre/cli/shared/absent.h"

#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/core.h>

namespace byre::cli {

std::string absence(const char* part, const char* packages, const char* option) {
  return fmt::format("this build has no {} (install {} and build byre with -D{}=ON)", part, packages, option);
}

Action declare_absent(CLI::App& command, const char* part, const char* packages, const char* option) {
  const std::string reason = absence(part, packages, option);
  command.allow_extras();
  command.footer("Not available: " + reason + ".");
  return [name = command.get_name(), reason](std::ostream&) -> ExitCode {
    throw std::runtime_error("byre " + name + ": " + reason);
  };
}

}  // namespace byre::cli
