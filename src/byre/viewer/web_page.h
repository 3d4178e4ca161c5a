#pragma once

#include <string_view>

namespace byre {

// The viewer's page, whole in one piece of HTML: what web/ was built to, as it was when byre was compiled.
std::string_view web_page();

}  // namespace byre
