#pragma once

#include "byre/base/printable.h"

#include <cmath>
#include <string>
#include <string_view>

#include <fmt/core.h>

namespace byre {

// A line of a report: a label padded to 12 characters, and content, which may be text from outside.
inline std::string row(std::string_view label, std::string_view content) {
  return fmt::format("{:12} {}\n", printable(label), printable(content));
}

// "1:02:03", or "12:34" below an hour; rounded up to whole seconds.
inline std::string format_duration(double seconds) {
  const auto total = static_cast<long long>(std::ceil(seconds));
  const long long hours = total / 3600, minutes = total / 60 % 60;
  if (hours > 0) return fmt::format("{}:{:02}:{:02}", hours, minutes, total % 60);
  return fmt::format("{}:{:02}", minutes, total % 60);
}

}  // namespace byre
