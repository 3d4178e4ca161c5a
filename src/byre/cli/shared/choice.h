#pragma once

#include <initializer_list>
#include <map>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

namespace byre::cli {

// A switch that takes one of these values by their names. The value must outlive the parsing of the command line.
template <typename Value>
void add_choice(CLI::App& command, const char* name, std::optional<Value>& value, std::initializer_list<Value> known,
                const char* help) {
  std::map<std::string, Value> by_name;
  std::string names;
  for (const Value each : known) {
    by_name.emplace(name_of(each), each);
    names += (names.empty() ? "" : "|") + std::string(name_of(each));
  }
  command.add_option(name, value, help)->type_name(names)->transform(CLI::CheckedTransformer(by_name).description(""));
}

}  // namespace byre::cli
