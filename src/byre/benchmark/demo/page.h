#pragma once

#include "byre/benchmark/demo/findings.h"

#include <string>

namespace byre {

// The demonstration as one self-contained HTML page that needs no network. Follows the system's dark mode.
std::string demo_page(const DemoFindings& findings);

// Data URL of a picture.
std::string data_address(const std::string& svg);

}  // namespace byre
