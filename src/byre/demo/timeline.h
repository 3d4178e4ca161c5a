#pragma once

#include "byre/demo/findings.h"

#include <string>

namespace byre {

// What became of each frame of the second visit, over time: the verdict of each arm, the points that held the hybrid's
// pose, and how far off the published positions were. An SVG element to stand in a page, whose colours come from the
// page's style sheet by class (see demo_page.cc).
std::string demo_timeline(const DemoFindings& findings);

}  // namespace byre
