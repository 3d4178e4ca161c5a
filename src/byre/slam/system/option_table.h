#pragma once

#include "byre/slam.h"
#include "byre/slam/system/method_options.h"

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace byre {

// Option of a Slam, by name and text. Inputs of a run (recording, maps, vocabulary, given calibration) are no
// options.
struct MethodOption {
  std::string name;     // groups and a word, separated by dots: tracking.search_radius_px
  std::string unit;     // in words; empty for flags and choices
  std::string range;    // "from 1 to 100" or "first|together"
  std::string meaning;  // a noun phrase
  std::function<std::string(const MethodOptions&)> get;            // shortest text from which set restores the value
  std::function<bool(MethodOptions&, std::string_view text)> set;  // false for an invalid value
};

// All options, by group.
const std::vector<MethodOption>& option_table();

// Names and values of options that differ from the default.
std::vector<std::pair<std::string, std::string>> changed_options(const MethodOptions& options);

// Options of the public API with the same effect.
SlamOptions slam_options(const MethodOptions& options);

// Reason for rejecting an option.
struct OptionFault {
  std::string reason;
  std::string remedy;
};

// Empty on success. For an unknown name the remedy is the most similar option.
std::optional<OptionFault> set_option(MethodOptions& options, std::string_view name, std::string_view text);

}  // namespace byre
