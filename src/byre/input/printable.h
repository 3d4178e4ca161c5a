#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace byre {

// Text from outside (names of files and topics, notes, messages, arguments) as part of one line for a terminal or a
// log. Printable UTF-8 stays as it is. Line feeds, tabs and carriage returns become \n, \t and \r; bytes of other
// control characters, of characters that change the direction of writing, and of invalid UTF-8 become \xNN. Longer than
// most bytes, the text is cut and ends in "...". Applied twice it gives the same as once.
std::string printable(std::string_view text, std::size_t most = std::string_view::npos);

}  // namespace byre
