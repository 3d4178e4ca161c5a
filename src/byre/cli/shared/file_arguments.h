#pragma once

#include "byre/io/recording/file_safety.h"

#include <functional>
#include <optional>
#include <string>

#include <CLI/App.hpp>

namespace byre::cli {

using Input = InputKind;
using Output = OutputKind;

// Every argument that takes free text is declared as an input, an output or text. So no command can overwrite its
// input, and tests detect undeclared arguments.

// All return the option. Empty names are rejected, as from an unset shell variable.
CLI::Option* declare(CLI::Option* option, Input input);
CLI::Option* declare(CLI::Option* option, Output output);
CLI::Option* declare_text(CLI::Option* option);  // text that is no file name

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

// Declaration of an option; empty without one.
std::optional<Input> input_of(CLI::Option& option);
std::optional<Output> output_of(CLI::Option& option);
bool is_text(CLI::Option& option);

// --no-overwrite: existing files are not replaced.
void declare_no_overwrite(CLI::App& command);

// Call it after parsing of a command and its subcommands. Throws CLI::ValidationError for outputs that file_safety.h
// rejects.
void require_safe_files(CLI::App& command);

// Throws InputError for an input that is a pipe or a device, which may never end, or a cyclic link.
void require_files_or_folders(CLI::App& command);

// Runs these checks after parsing, then the command's own check.
void check_when_parsed(CLI::App& command, std::function<void()> check = {});

}  // namespace byre::cli
