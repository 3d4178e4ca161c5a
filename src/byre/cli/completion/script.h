#pragma once

#include <string>
#include <vector>

#include <CLI/App.hpp>

namespace byre::cli {

// Scripts that complete a program's commands, their options and what these take, made from how all are declared: files
// and folders for inputs and outputs, the choices of a type like "first|second".
std::string bash_completion(CLI::App& program);
std::string zsh_completion(CLI::App& program);

// Words that an option takes, as its type lists them; empty where it takes other things.
std::vector<std::string> choices_of(const CLI::Option& option);

}  // namespace byre::cli
