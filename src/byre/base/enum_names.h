#pragma once

#include <cstddef>
#include <string_view>

namespace byre {

// Name of an enumerator, from the names of all enumerators in their order. kLast: the last enumerator; they count from
// zero. A new enumerator is appended to the enumeration, and kLast changes with it.
template <auto kLast, std::size_t kNames>
constexpr std::string_view name_among(const std::string_view (&names)[kNames], decltype(kLast) value) {
  static_assert(kNames == static_cast<std::size_t>(kLast) + 1, "one name for each enumerator");
  const auto index = static_cast<std::size_t>(value);
  return index < kNames ? names[index] : std::string_view();
}

}  // namespace byre
