#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace byre {

// Escapes text from outside (names of files and topics, notes, messages, arguments) for one line of a terminal or a
// log. Printable UTF-8 is unchanged. Line feeds, tabs and carriage returns become \n, \t and \r. Bytes of other control
// characters, of characters that change the writing direction, and of invalid UTF-8 become \xNN. Text of more than
// `most` bytes is cut and ends in "...". Without a cut, a second application changes nothing.
std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

// Same, for text of several lines: line feeds are unchanged.
std::string printable_lines(std::string_view text);

// JSON text with the characters that printable() escapes as \uNNNN in its strings, so that readers get the same
// strings. Precondition: the text is valid JSON in UTF-8, whose control characters below U+0020 are escaped or between
// values.
std::string printable_json(std::string_view json);

}  // namespace byre
