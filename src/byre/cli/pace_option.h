#pragma once

#include "byre/playback/map_run.h"

#include <CLI/App.hpp>

namespace byre::cli {

// --pace. The pace must outlive the parsing of the command line.
void declare_pace(CLI::App& command, Pace& pace);

}  // namespace byre::cli
