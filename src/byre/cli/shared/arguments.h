#pragma once

#include "byre/base/printable.h"
#include "byre/io/recording/file_safety.h"

#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

#include <CLI/CLI.hpp>

namespace byre::cli {

using Input = InputKind;
using Output = OutputKind;

// Every argument that takes free text is declared as an input, an output or text. So no command can overwrite its
// input, and tests detect undeclared arguments.

// All return the option, whose help shows the usual type of such files. Empty names are rejected, as from an unset
// shell variable.
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

// Message on the first argument that is no command and no option, with the name that it likely stands for. Empty
// without such an argument. Call it after parsing.
std::string unknown_argument(const CLI::App& app, const std::vector<std::string>& arguments);

// Validators of numbers; reject NaN and infinity; not shown in the help.
CLI::Validator between(double low, double high);  // both inclusive
CLI::Validator from(double low);
CLI::Validator above_zero();

// Maps a name to the text of its value, an enumerator, bool or string. Rejects other text with the list of names.
template <typename Value>
CLI::Validator one_of(const std::map<std::string, Value>& by_name) {
  const auto transform = [by_name](std::string& text) {
    const auto found = by_name.find(text);
    if (found == by_name.end()) {
      std::string names;
      for (const auto& [name, value] : by_name) names += (names.empty() ? "" : ", ") + name;
      return "'" + printable(text) + "' is not one of: " + names;
    }
    if constexpr (std::is_enum_v<Value>) {
      text = std::to_string(static_cast<std::underlying_type_t<Value>>(found->second));
    } else if constexpr (std::is_same_v<Value, bool>) {
      text = found->second ? "true" : "false";
    } else {
      text = found->second;
    }
    return std::string();
  };
  return CLI::Validator(transform, "");
}

// Option with the values as choices by name. The value must outlive the parsing of the command line.
template <typename Value>
void add_choice(CLI::App& command, const char* name, std::optional<Value>& value, std::initializer_list<Value> known,
                const char* help) {
  std::map<std::string, Value> by_name;
  std::string names;
  for (const Value each : known) {
    by_name.emplace(name_of(each), each);
    names += (names.empty() ? "" : "|") + std::string(name_of(each));
  }
  command.add_option(name, value, help)->type_name(names)->transform(one_of(by_name));
}

}  // namespace byre::cli
