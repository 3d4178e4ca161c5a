#pragma once

#include "byre/cli/commands.h"

#include <string>

namespace byre::cli {

// Declares a command that this build lacks: it accepts any arguments, and its action fails with reason and remedy.
// part: such as "ray tracing"; packages: of Debian, that the build needs; option: of CMake, such as "BYRE_WITH_EMBREE".
Action declare_absent(CLI::App& command, const char* part, const char* packages, const char* option);

// Text of this error after the name of the command or option.
std::string absence(const char* part, const char* packages, const char* option);

}  // namespace byre::cli
