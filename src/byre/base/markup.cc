#include "byre/base/markup.h"

#include "byre/base/printable.h"

#include <array>

namespace byre {

std::string markup_escaped(std::string_view text) {
  constexpr std::string_view kSpecial = "&<>\"";
  constexpr std::array<std::string_view, 4> kNames = {"&amp;", "&lt;", "&gt;", "&quot;"};
  std::string safe;
  for (const char character : printable(text)) {
    const std::size_t found = kSpecial.find(character);
    if (found == std::string_view::npos) {
      safe += character;
    } else {
      safe += kNames[found];
    }
  }
  return safe;
}

}  // namespace byre
