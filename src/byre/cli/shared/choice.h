#pragma once

#include "byre/base/printable.h"

#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <type_traits>

#include <CLI/CLI.hpp>

namespace byre::cli {

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
