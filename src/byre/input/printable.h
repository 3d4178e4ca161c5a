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

}  // namespace byre
