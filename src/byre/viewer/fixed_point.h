#pragma once

#include <array>
#include <charconv>
#include <string>

namespace byre {

// Number with fixed decimals, independent of the locale. Precondition: at most a hundred characters.
inline std::string fixed_point(double value, int decimals) {
  std::array<char, 128> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  return {text.data(), end};
}

}  // namespace byre
