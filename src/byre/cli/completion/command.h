#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace byre::cli {

// Shell scripts that complete commands, options and values, generated from the declarations: files and folders for
// inputs and outputs, choices of types like "first|second".
std::string bash_completion(CLI::App& program);
std::string zsh_completion(CLI::App& program);

// Choices in the type of an option; empty if it has none.
std::vector<std::string> choices_of(const CLI::Option& option);

}  // namespace byre::cli
