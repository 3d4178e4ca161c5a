#pragma once

#include "byre/cli/demo_findings.h"

#include <string>

namespace byre::cli {

// The page that shows a demonstration: one HTML file that needs no other, and no network. Dark where the reader's
// system is.
std::string demo_page(const DemoFindings& findings);

// Text to stand in HTML, in an attribute too.
std::string html_escaped(const std::string& text);

// A picture as the address of an image that holds it.
std::string data_address(const std::string& svg);

}  // namespace byre::cli
