#pragma once

#include "byre/system/engine.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre {

// One thing that can be set of an Engine, by name and as text. What a run is given (recording, maps, vocabulary, known
// calibration) is none.
struct EngineOption {
  std::string name;     // groups and a word, with dots between them: tracking.search_radius_px
  std::string unit;     // in words; empty for flags and choices
  std::string range;    // "from 1 to 100" or "first|together"
  std::string meaning;  // a noun phrase
  std::function<std::string(const EngineOptions&)> get;            // shortest text that set takes back exactly
  std::function<bool(EngineOptions&, std::string_view text)> set;  // false for what is no value of it, or out of range
};

// All of them, in groups.
const std::vector<EngineOption>& option_table();

// Names and values of those that are not as by default.
std::vector<std::pair<std::string, std::string>> changed_options(const EngineOptions& options);

// Why an option could not be set.
struct OptionFault {
  std::string reason;
  std::string remedy;
};

// Empty once it is set. An unknown name is told with the known one that is most like it.
std::optional<OptionFault> set_option(EngineOptions& options, std::string_view name, std::string_view text);

}  // namespace byre
