#pragma once

#include <functional>
#include <iosfwd>

#include <CLI/App.hpp>

namespace byre::cli {

// Does what a command is for, with the options it was given, and writes its result. Throws InputError for bad input and
// any other exception for a failure at work.
using Action = std::function<void(std::ostream& result)>;

// Each declares the options of a command, and lives in a file of the command's name. The action is to be called once
// the command line is parsed.
Action declare_evaluate(CLI::App& command);

}  // namespace byre::cli
