#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace byre {

// Name that a misspelt or shortened one likely stands for: by the fewest letters inserted, removed, replaced or swapped
// with the next one. Empty if none is close.
std::optional<std::string> nearest_name(std::string_view given, const std::vector<std::string>& names);

}  // namespace byre
