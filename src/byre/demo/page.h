#pragma once

#include "byre/demo/findings.h"

#include <string>

namespace byre {

// The page that shows a demonstration: one HTML file that needs no other, and no network. Dark where the reader's
// system is.
std::string demo_page(const DemoFindings& findings);

// A picture as the address of an image that holds it.
std::string data_address(const std::string& svg);

}  // namespace byre
