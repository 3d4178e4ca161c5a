#pragma once

#include <string>
#include <string_view>

namespace byre {

// Text to stand in XML or HTML, in an attribute too.
std::string markup_escaped(std::string_view text);

}  // namespace byre
