#pragma once

#include "byre/benchmark/demo/findings.h"

#include <string>

namespace byre {

// Timeline of the second visit: verdict of each arm, points that hold the hybrid's pose, and errors of published
// positions. An SVG element for embedding; its colours come from the page's style sheet by class (page.cc).
std::string demo_timeline(const DemoFindings& findings);

}  // namespace byre
