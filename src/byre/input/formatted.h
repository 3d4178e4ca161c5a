#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace byre {

// As snprintf, cut off after 255 characters.
template <typename... Values>
std::string formatted(const char* format, Values... values) {
  std::array<char, 256> text{};
  std::snprintf(text.data(), text.size(), format, values...);
  return text.data();
}

// A line of a report: what it is about, then what there is to say of it.
inline std::string row(const char* name, const std::string& content) {
  return formatted("%-12s ", name) + content + "\n";
}

// "1:02:03", or "12:34" below an hour; begun seconds count.
inline std::string format_duration(double seconds) {
  const auto total = static_cast<long long>(std::ceil(seconds));
  const long long hours = total / 3600, minutes = total / 60 % 60;
  if (hours > 0) return formatted("%lld:%02lld:%02lld", hours, minutes, total % 60);
  return formatted("%lld:%02lld", minutes, total % 60);
}

}  // namespace byre
