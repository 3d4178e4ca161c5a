#pragma once

#include "byre/dataset/file_safety.h"

#include <functional>
#include <optional>
#include <string>

#include <CLI/App.hpp>

namespace byre::cli {

using Input = InputKind;
using Output = OutputKind;

// What an argument of a command names is declared beside it. Every argument that takes any text is declared as an
// input, an output or text: so no command can destroy what it reads, and a new one cannot be forgotten.

// All give the option back. An empty name is refused, as that of a shell variable that is not set.
CLI::Option* declare(CLI::Option* option, Input input);
CLI::Option* declare(CLI::Option* option, Output output);
CLI::Option* declare_text(CLI::Option* option);  // text that is no file's name

template <typename Value>
CLI::Option* add_input(CLI::App& command, Input input, const std::string& name, Value& value, const std::string& help) {
  return declare(command.add_option(name, value, help), input);
}

template <typename Value>
CLI::Option* add_output(CLI::App& command, Output output, const std::string& name, Value& value,
                        const std::string& help) {
  return declare(command.add_option(name, value, help), output);
}

template <typename Value>
CLI::Option* add_text(CLI::App& command, const std::string& name, Value& value, const std::string& help) {
  return declare_text(command.add_option(name, value, help));
}

// What an option was declared as; empty for others.
std::optional<Input> input_of(CLI::Option& option);
std::optional<Output> output_of(CLI::Option& option);
bool is_text(CLI::Option& option);

// --no-overwrite: no file that is there is replaced.
void declare_no_overwrite(CLI::App& command);

// Once a command and its subcommands are parsed. Throws CLI::ValidationError for outputs that file_safety.h refuses.
void require_safe_files(CLI::App& command);

// Throws InputError for an input that is a pipe or a device, which may never end, or a link round in a circle.
void require_files_or_folders(CLI::App& command);

// Checks that after the command line is parsed, and then what the command itself has to say against it.
void check_when_parsed(CLI::App& command, std::function<void()> check = {});

}  // namespace byre::cli
