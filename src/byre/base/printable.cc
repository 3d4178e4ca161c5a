#include "byre/base/printable.h"

#include <array>
#include <cstdint>

#include <fmt/core.h>

namespace byre {
namespace {

// A UTF-8 character. An invalid byte counts as a character of one byte.
struct Utf8Character {
  std::uint32_t code = 0;
  std::size_t bytes = 1;
  bool is_valid = false;
};

// Unicode 15, table 3-7: no overlong forms, no surrogates, nothing beyond U+10FFFF.
Utf8Character first_character(std::string_view text) {
  const auto byte = [text](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  if (byte(0) < 0x80) return {byte(0), 1, true};
  constexpr std::array<std::uint32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const std::size_t bytes = byte(0) >= 0xF0 ? 4 : byte(0) >= 0xE0 ? 3 : 2;
  if (byte(0) < 0xC2 || byte(0) > 0xF4 || text.size() < bytes) return {};
  std::uint32_t code = byte(0) & (0x7FU >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xC0U) != 0x80) return {};
    code = code << 6 | (byte(i) & 0x3FU);
  }
  if (code < kLeast[bytes] || code > 0x10FFFF || (code >= 0xD800 && code <= 0xDFFF)) return {};
  return {code, bytes, true};
}

bool is_printable(std::uint32_t code) {
  if (code < 0x20 || (code >= 0x7F && code < 0xA0)) return false;
  const bool is_line_end_or_direction = code == 0x200E || code == 0x200F || (code >= 0x2028 && code <= 0x202E) ||
                                        (code >= 0x2066 && code <= 0x2069) || code == 0xFEFF;
  return !is_line_end_or_direction;
}

// "\\n", "\\t", "\\r", else "\\xNN" for each byte.
std::string byte_escapes(std::string_view bytes) {
  std::string text;
  for (const char each : bytes) {
    if (each == '\n' || each == '\t' || each == '\r') {
      text += each == '\n' ? "\\n" : each == '\t' ? "\\t" : "\\r";
    } else {
      text += fmt::format("\\x{:02x}", static_cast<std::uint8_t>(each));
    }
  }
  return text;
}

// Replaces characters. escape: the replacement of a character by its code and bytes; empty to keep it.
template <typename Escape>
std::string with_escapes(std::string_view text, const Escape& escape) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const Utf8Character next = first_character(text);
    const std::string_view bytes = text.substr(0, next.bytes);
    text.remove_prefix(next.bytes);
    const std::string escaped = escape(next, bytes);
    result += escaped.empty() ? bytes : std::string_view(escaped);
  }
  return result;
}

}  // namespace

std::string printable(std::string_view text, std::size_t most) {
  const bool is_cut = text.size() > most;
  const std::string result = with_escapes(text.substr(0, most), [](const Utf8Character& next, std::string_view bytes) {
    return next.is_valid && is_printable(next.code) ? std::string() : byte_escapes(bytes);
  });
  return is_cut ? result + "..." : result;
}

std::string printable_lines(std::string_view text) {
  return with_escapes(text, [](const Utf8Character& next, std::string_view bytes) {
    return next.is_valid && (is_printable(next.code) || next.code == '\n') ? std::string() : byte_escapes(bytes);
  });
}

std::string printable_json(std::string_view json) {
  return with_escapes(json, [](const Utf8Character& next, std::string_view) {
    return next.code < 0x7F || is_printable(next.code) ? std::string() : fmt::format("\\u{:04x}", next.code);
  });
}

}  // namespace byre
