#pragma once

#include <string_view>

namespace byre {

// HTML of the viewer's page, built from web/ and embedded at compile time.
std::string_view web_page();

}  // namespace byre
