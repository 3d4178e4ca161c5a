#pragma once

#include <array>
#include <cstdio>
#include <string>

namespace byre::cli {

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

}  // namespace byre::cli
