#pragma once

#include <string>
#include <string_view>

namespace byre {

// Text of one line in XML or HTML, also in an attribute. Control characters are escaped by printable().
std::string markup_escaped(std::string_view text);

}  // namespace byre
