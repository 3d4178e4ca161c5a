#include "byre/cli/shared/unknown_argument.h"

#include "byre/base/nearest_name.h"

#include <algorithm>

#include <CLI/CLI.hpp>

namespace byre::cli {
namespace {

std::string message(const char* kind, const std::string& unknown, const std::vector<std::string>& names) {
  const auto nearest = nearest_name(unknown, names);
  return std::string("unknown ") + kind + " '" + unknown + "'" + (nearest ? " (did you mean '" + *nearest + "'?)" : "");
}

std::vector<std::string> names_of(const std::vector<const CLI::App*>& commands) {
  std::vector<std::string> names;
  for (const CLI::App* const command : commands) {
    names.push_back(command->get_name());
    names.insert(names.end(), command->get_aliases().begin(), command->get_aliases().end());
  }
  return names;
}

std::vector<std::string> long_options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

}  // namespace

std::string unknown_argument(const CLI::App& app, const std::vector<std::string>& arguments) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  const auto subcommands = command->get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> unparsed = command->remaining();
  for (const std::string& argument : arguments) {
    if (std::ranges::find(unparsed, argument) == unparsed.end()) continue;
    if (argument.starts_with("-")) {
      return message("option", argument.substr(0, argument.find('=')), long_options_of(*command));
    }
    if (!subcommands.empty()) return message("command", argument, names_of(subcommands));
  }
  return "";
}

}  // namespace byre::cli
